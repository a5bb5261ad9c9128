// A glTF file with much in it, for tests that damage it and as a seed of the fuzz target.
#pragma once
#include "support/gltf_builder.h"

namespace kestrel::test {

// A file with a skin, a morph target, an animation, a texture, a camera and a light.
inline GltfBuilder richFile() {
    using nlohmann::json;
    GltfBuilder builder = triangleFile();
    json& document = builder.document;
    json& primitive = document["meshes"][0]["primitives"][0];
    primitive["attributes"]["JOINTS_0"] =
        builder.accessor<std::uint8_t>({0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0}, 4, UnsignedByte);
    primitive["attributes"]["WEIGHTS_0"] = builder.floats({0.5f, 0.5f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4);
    primitive["attributes"]["NORMAL"] = builder.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
    primitive["targets"] = {{{"POSITION", 0}}};
    primitive["material"] = 0;
    document["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    document["textures"] = {{{"source", 0}}};
    const std::vector<std::uint8_t> png = {
        137, 80, 78, 71, 13, 10, 26,  10,  0,  0,   0,  13, 73, 72, 68, 82, 0,  0,  0,   1,   0,  0,   0,
        1,   8,  2,  0,  0,  0,  144, 119, 83, 222, 0,  0,  0,  12, 73, 68, 65, 84, 120, 218, 99, 248, 207,
        192, 0,  0,  3,  1,  1,  0,   247, 3,  65,  67, 0,  0,  0,  0,  73, 69, 78, 68,  174, 66, 96,  130};
    document["images"] = {{{"bufferView", builder.view(png)}, {"mimeType", "image/png"}}};
    document["nodes"] = json::parse(R"([{"mesh": 0, "skin": 0}, {"children": [2], "camera": 0}, {},
        {"extensions": {"KHR_lights_punctual": {"light": 0}}}])");
    document["scenes"][0]["nodes"] = {0, 1, 3};
    const std::vector<float> identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    std::vector<float> two = identity;
    two.insert(two.end(), identity.begin(), identity.end());
    document["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", builder.floats(two, 16)}}};
    document["cameras"] =
        json::parse(R"([{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}])");
    document["extensions"] =
        json::parse(R"({"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}]}})");
    document["extensionsUsed"] = {"KHR_lights_punctual"};
    const size_t times = builder.floats({0, 1}, 1), values = builder.floats({0, 0, 0, 1, 1, 1}, 3);
    document["animations"] = {
        {{"samplers", {{{"input", times}, {"output", values}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}}};
    return builder;
}

} // namespace kestrel::test
