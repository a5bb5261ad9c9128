// Files that are broken or mean harm: one line that names the file and what is wrong, never a crash.
#include "scene/gltf_draco.h"
#include "scene/gltf_export.h"
#include "scene/gltf_import.h"
#include "support/gltf_builder.h"
#include "support/message.h"
#include "unit/scene_gltf_rich.h"
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace kestrel {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::richFile;
using test::TemporaryFolder;

// What loading `bytes` as a file says; "no error" where it loads.
std::string loadMessage(const TemporaryFolder& folder, std::span<const std::byte> bytes, const char* name) {
    writeFile(folder / name, bytes);
    return test::messageOf([&] { (void)loadScene((folder / name).string()); });
}

std::string loadMessage(const std::string& text) {
    const TemporaryFolder folder;
    return loadMessage(folder, std::as_bytes(std::span(text)), "bad.gltf");
}

TEST(GltfHostile, TheRichFileIsGood) { EXPECT_EQ(loadMessage(richFile().text()), "no error"); }

struct Case {
    const char* name;
    std::function<void(GltfBuilder&)> spoil;
    const char* message; // part of the one line
};

void setFloat(GltfBuilder& builder, size_t view, size_t index, float value) {
    const size_t offset = builder.document["bufferViews"][view]["byteOffset"].get<size_t>();
    std::memcpy(builder.data.data() + offset + 4 * index, &value, sizeof value);
}

const Case cases[] = {
    {"index accessor", [](GltfBuilder& b) { b.document["meshes"][0]["primitives"][0]["indices"] = 77; },
     "meshes[0].primitives[0].indices is 77, but there are 8 accessors"},
    {"negative index", [](GltfBuilder& b) { b.document["nodes"][0]["mesh"] = -1; },
     "nodes[0].mesh is -1, but there are 1 meshes"},
    {"huge index", [](GltfBuilder& b) { b.document["nodes"][0]["mesh"] = 4294967296; },
     "nodes[0].mesh is 4294967296, but there are 1 meshes"},
    {"fractional index", [](GltfBuilder& b) { b.document["nodes"][0]["mesh"] = 0.5; },
     "nodes[0].mesh is not a whole number"},
    {"wrong type", [](GltfBuilder& b) { b.document["nodes"] = 3; }, "nodes is not an array"},
    {"missing member", [](GltfBuilder& b) { b.document["accessors"][0].erase("type"); },
     "accessors[0].type is missing"},
    {"unknown choice", [](GltfBuilder& b) { b.document["accessors"][0]["type"] = "VEC9"; },
     "accessors[0] (meshes[0].primitives[0].POSITION) is of the type 'VEC9', which Kestrel does not know"},
    {"vertex index",
     [](GltfBuilder& b) { b.data[static_cast<size_t>(b.document["bufferViews"][1]["byteOffset"])] = 3; },
     "meshes[0].primitives[0] has the index 3, but 3 vertices"},
    {"NaN", [](GltfBuilder& b) { setFloat(b, 0, 4, std::numeric_limits<float>::quiet_NaN()); },
     "accessors[0] (meshes[0].primitives[0].POSITION) is NaN at element 1"},
    {"infinity", [](GltfBuilder& b) { setFloat(b, 0, 8, -INFINITY); },
     "accessors[0] (meshes[0].primitives[0].POSITION) is infinite at element 2"},
    {"NaN weight", [](GltfBuilder& b) { setFloat(b, 3, 0, std::numeric_limits<float>::quiet_NaN()); },
     "WEIGHTS_0) is NaN"},
    {"negative weight", [](GltfBuilder& b) { setFloat(b, 3, 0, -1); }, "WEIGHTS_0 has a negative weight"},
    {"beyond its view", [](GltfBuilder& b) { b.document["accessors"][0]["count"] = 4; },
     "has 4 elements of 12 bytes from byte 0 on, beyond bufferViews[0], which has 36 bytes"},
    {"offset beyond its view", [](GltfBuilder& b) { b.document["accessors"][0]["byteOffset"] = 40; },
     "from byte 40 on, beyond bufferViews[0]"},
    {"giant count", [](GltfBuilder& b) { b.document["accessors"][0]["count"] = 9000000000000000; },
     "has 9000000000000000 elements of 12 bytes"},
    {"giant count without data",
     [](GltfBuilder& b) {
         b.document["accessors"][0]["count"] = 9000000000000000;
         b.document["accessors"][0].erase("bufferView");
         b.document["meshes"][0]["primitives"][0].erase("indices");
     },
     "at most 2147483648 bytes are decoded"},
    {"overflowing offset",
     [](GltfBuilder& b) { b.document["bufferViews"][0]["byteOffset"] = 9000000000000000; },
     "bufferViews[0] has bytes 9000000000000000 to"},
    {"view beyond its buffer", [](GltfBuilder& b) { b.document["bufferViews"][0]["byteLength"] = 100000; },
     "bufferViews[0] has bytes 0 to 100000 of buffers[0]"},
    {"stride below its element", [](GltfBuilder& b) { b.document["bufferViews"][0]["byteStride"] = 8; },
     "has elements of 12 bytes in a stride of 8"},
    {"zero length", [](GltfBuilder& b) { b.document["bufferViews"][0]["byteLength"] = 0; },
     "bufferViews[0].byteLength is 0, which is out of range"},
    {"zero count", [](GltfBuilder& b) { b.document["accessors"][0]["count"] = 0; },
     "accessors[0].count is 0, which is out of range"},
    {"buffer shorter than stated",
     [](GltfBuilder& b) {
         b.document["buffers"] = {{{"byteLength", 9}, {"uri", "data:;base64,AAAA"}}};
     },
     "buffers[0].byteLength is 9, but its data has 3 bytes"},
    {"broken base64",
     [](GltfBuilder& b) {
         b.document["buffers"] = {{{"byteLength", 3}, {"uri", "data:;base64,A!AA"}}};
     },
     "buffers[0] has a data URI with broken base64"},
    {"buffer outside",
     [](GltfBuilder& b) {
         b.document["buffers"] = {{{"byteLength", 3}, {"uri", "../secret.bin"}}};
     },
     "buffers[0]: '../secret.bin' leaves the folder"},
    {"buffer outside, encoded",
     [](GltfBuilder& b) {
         b.document["buffers"] = {{{"byteLength", 3}, {"uri", "%2e%2e/secret.bin"}}};
     },
     "leaves the folder"},
    {"absolute buffer",
     [](GltfBuilder& b) {
         b.document["buffers"] = {{{"byteLength", 3}, {"uri", "/etc/passwd"}}};
     },
     "'/etc/passwd' leaves the folder"},
    {"remote buffer",
     [](GltfBuilder& b) {
         b.document["buffers"] = {{{"byteLength", 3}, {"uri", "https://a.b/c"}}};
     },
     "buffers[0] is at 'https://a.b/c'; only files are read"},
    {"missing buffer",
     [](GltfBuilder& b) {
         b.document["buffers"] = {{{"byteLength", 3}, {"uri", "no.bin"}}};
     },
     "buffers[0]: 'no.bin' no such file"},
    {"folder as buffer",
     [](GltfBuilder& b) {
         b.document["buffers"] = {{{"byteLength", 3}, {"uri", "."}}};
     },
     "buffers[0]: '.' is not a file"},
    {"image of nothing",
     [](GltfBuilder& b) {
         b.document["images"] = {{{"name", "x"}}};
     },
     "images[0] has neither uri nor bufferView"},
    {"broken image",
     [](GltfBuilder& b) {
         b.document["images"] = {{{"uri", "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAI="}}};
     },
     "images[0] is a broken image"},
    {"giant image",
     [](GltfBuilder& b) {
         b.document["images"] = {
             {{"uri",
               "data:image/"
               "png;base64,iVBORw0KGgoAAAANSUhEUgAAYAAAAAABCAIAAAAvYa7YAAAAAElEQVQ1rwYeAAAAAElFTkSuQmCC"}}};
     },
     "images[0] has 24576 x 1 pixels; at most 16384 to a side"},
    {"cycle", [](GltfBuilder& b) { b.document["nodes"][2]["children"] = {1}; }, "the hierarchy has a cycle"},
    {"own child",
     [](GltfBuilder& b) {
         b.document["nodes"][2]["children"] = {2};
         b.document["nodes"][1].erase("children");
     },
     "nodes[2] is above itself"},
    {"two parents", [](GltfBuilder& b) { b.document["nodes"][0]["children"] = {2}; },
     "nodes[2] has two parents, 0 and 1"},
    {"root with a parent",
     [](GltfBuilder& b) {
         b.document["scenes"][0]["nodes"] = {0, 2};
     },
     "scenes[0] has nodes[2] at its root, which has a parent"},
    {"root twice",
     [](GltfBuilder& b) {
         b.document["scenes"][0]["nodes"] = {0, 0};
     },
     "has nodes[0] twice"},
    {"joint out of range", [](GltfBuilder& b) { b.document["skins"][0]["joints"] = {1}; },
     "a vertex of meshes[0] has the joint 1, but skins[0] has 1 joints"},
    {"joint node",
     [](GltfBuilder& b) {
         b.document["skins"][0]["joints"] = {1, 9};
     },
     "skins[0].joints[1] is 9, but there are 4 nodes"},
    {"no joints", [](GltfBuilder& b) { b.document["skins"][0]["joints"] = json::array(); },
     "skins[0] has no joints"},
    {"joints without weights",
     [](GltfBuilder& b) { b.document["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0"); },
     "has only one of JOINTS_0 and WEIGHTS_0"},
    {"inverse bind of another type",
     [](GltfBuilder& b) { b.document["skins"][0]["inverseBindMatrices"] = 0; },
     "(skins[0].inverseBindMatrices) is not MAT4"},
    {"attribute length",
     [](GltfBuilder& b) {
         b.document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = b.floats({0, 0, 1, 1}, 2);
     },
     "meshes[0].primitives[0].TEXCOORD_0 has 2 elements, but there are 3 vertices"},
    {"attribute type",
     [](GltfBuilder& b) { b.document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 3; },
     "is not VEC3"},
    {"float indices",
     [](GltfBuilder& b) {
         b.document["meshes"][0]["primitives"][0]["indices"] = b.floats({0, 1, 2}, 1);
     },
     "is not of unsigned integers"},
    {"sparse index",
     [](GltfBuilder& b) {
         b.document["accessors"][0]["sparse"] = {
             {"count", 1},
             {"indices",
              {{"bufferView", b.view(std::vector<std::uint8_t>{3})}, {"componentType", test::UnsignedByte}}},
             {"values", {{"bufferView", b.view(std::vector<float>{1, 2, 3})}}}};
     },
     "has the sparse index 3, but 3 elements"},
    {"sparse count",
     [](GltfBuilder& b) {
         b.document["accessors"][0]["sparse"] = {
             {"count", 4},
             {"indices", {{"bufferView", 0}, {"componentType", test::UnsignedByte}}},
             {"values", {{"bufferView", 0}}}};
     },
     "is sparse with 4 of 3 elements"},
    {"times that fall", [](GltfBuilder& b) { setFloat(b, 7, 1, -1); }, "animations[0].channels[0] input"},
    {"equal times", [](GltfBuilder& b) { setFloat(b, 7, 1, 0); }, "does not rise from element 0 to the next"},
    {"too few values",
     [](GltfBuilder& b) { b.document["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE"; },
     "animations[0].channels[0] output has 6 values; 2 keys need 18"},
    {"sampler", [](GltfBuilder& b) { b.document["animations"][0]["channels"][0]["sampler"] = 1; },
     "animations[0].channels[0].sampler is 1, but there are 1 samplers"},
    {"light",
     [](GltfBuilder& b) { b.document["nodes"][3]["extensions"]["KHR_lights_punctual"]["light"] = 1; },
     "light is 1, but there are 1 lights"},
    {"camera without volume", [](GltfBuilder& b) { b.document["cameras"][0]["perspective"]["znear"] = 0; },
     "cameras[0] has no volume"},
    {"camera without lens", [](GltfBuilder& b) { b.document["cameras"][0]["type"] = "orthographic"; },
     "cameras[0].orthographic is missing"},
    {"spot light without cone",
     [](GltfBuilder& b) { b.document["extensions"]["KHR_lights_punctual"]["lights"][0].erase("spot"); },
     "lights[0].spot is missing"},
    {"zero rotation",
     [](GltfBuilder& b) {
         b.document["nodes"][1]["rotation"] = {0, 0, 0, 0};
     },
     "nodes[1].rotation is zero"},
    {"short matrix",
     [](GltfBuilder& b) {
         b.document["nodes"][1]["matrix"] = {1, 2};
     },
     "nodes[1].matrix has 2 numbers, not 16"},
    {"projective matrix",
     [](GltfBuilder& b) {
         b.document["nodes"][1]["matrix"] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
     },
     "nodes[1].matrix is not affine"},
    {"transform out of range",
     [](GltfBuilder& b) {
         b.document["nodes"][0].erase("skin");
         b.document["nodes"][0]["scale"] = {1e30, 1, 1};
     },
     "the transforms of the nodes take vertices"},
    {"weights",
     [](GltfBuilder& b) {
         b.document["meshes"][0]["weights"] = {1, 2};
     },
     "meshes[0] has 2 weights for 1 morph targets"},
    {"required extension",
     [](GltfBuilder& b) {
         b.document["extensionsRequired"] = {"KHR_materials_volume", "KHR_mesh_quantization", "X"};
     },
     "requires extensions that Kestrel lacks: KHR_materials_volume, X"},
    {"compressed alone",
     [](GltfBuilder& b) {
         b.document["accessors"][0].erase("bufferView");
         b.document["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
             {"bufferView", 0}, {"attributes", {{"POSITION", 0}}}};
     },
     hasDraco() ? "meshes[0].primitives[0] holds no Draco data"
                : "is stored by KHR_draco_mesh_compression alone, which this build lacks"},
    {"version", [](GltfBuilder& b) { b.document["asset"]["version"] = "1.0"; },
     "is glTF 1.0; version 2 is read"},
    {"no version", [](GltfBuilder& b) { b.document.erase("asset"); },
     "is not glTF: asset.version is missing"},
    {"emission out of range",
     [](GltfBuilder& b) {
         b.document["materials"][0]["emissiveFactor"] = {1e38, 0, 0};
         b.document["materials"][0]["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] =
             1e38;
     },
     "has an emission that is out of range"},
};

TEST(GltfHostile, SaysInOneLineWhatIsWrong) {
    for (const Case& bad : cases) {
        SCOPED_TRACE(bad.name);
        GltfBuilder builder = richFile();
        bad.spoil(builder);
        const std::string message = loadMessage(builder.text());
        EXPECT_NE(message.find("bad.gltf"), std::string::npos) << message;
        EXPECT_NE(message.find(bad.message), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

TEST(GltfHostile, JsonThatIsNoneHasAPlace) {
    EXPECT_NE(loadMessage("{\n  \"asset\": nil}").find("bad.gltf:2:"), std::string::npos)
        << loadMessage("{\n  \"asset\": nil}");
    EXPECT_NE(loadMessage("[]").find("is not an object"), std::string::npos);
    EXPECT_NE(loadMessage("").find("the file is empty"), std::string::npos);
    EXPECT_NE(loadMessage("{\"asset\": 1e999}").find("a number is too large: '1e999'"), std::string::npos);
    EXPECT_NE(loadMessage(std::string(1000, '[')).find("nested more than 64 levels"), std::string::npos);
}

std::string messageWith(const GltfBuilder& builder, const GltfLimits& limits) {
    const TemporaryFolder folder;
    writeFile(folder / "large.gltf", builder.text());
    try {
        (void)importGltf(folder / "large.gltf", {}, limits);
        return {};
    } catch (const InputError& error) {
        return error.what();
    }
}

TEST(GltfHostile, LimitsHold) {
    const auto expect = [](const GltfBuilder& builder, const GltfLimits& tooLow, const GltfLimits& enough,
                           const std::string& part) {
        const std::string message = messageWith(builder, tooLow);
        EXPECT_NE(message.find(part), std::string::npos) << message;
        EXPECT_EQ(messageWith(builder, enough), "");
    };
    const GltfBuilder rich = richFile();
    expect(rich, {.jsonValues = 50}, {.jsonValues = 1000}, "the JSON has more than 50 values");
    expect(rich, {.decodedPixels = 0}, {.decodedPixels = 1}, "images[0] has 1 x 1 pixels");
    expect(rich, {.decodedBytes = 35}, {.decodedBytes = 1000},
           "has 3 elements; at most 35 bytes are decoded");
    expect(rich, {.joints = 1}, {.joints = 2}, "more than 1 joints in total");
    // Primitives and channels that share accessors take memory each.
    GltfBuilder shared = richFile();
    json& primitives = shared.document["meshes"][0]["primitives"];
    for (int i = 0; i < 9; ++i) primitives.push_back(primitives[0]);
    expect(shared, {.storedBytes = 2000}, {.storedBytes = 4000},
           "the meshes and animations take more than 2000 bytes");
    shared = richFile();
    json& channels = shared.document["animations"][0]["channels"];
    for (int i = 0; i < 99; ++i) channels.push_back(channels[0]);
    expect(shared, {.storedBytes = 2000}, {.storedBytes = 4000}, "animations[0].channels[");
}

TEST(GltfHostile, WarningsAreNotEndless) {
    GltfBuilder builder = test::triangleFile();
    for (int i = 0; i < 1000; ++i) builder.document["extensionsUsed"].push_back("X_" + std::to_string(i));
    const TemporaryFolder folder;
    const Scene scene = builder.import(folder);
    EXPECT_EQ(scene.warnings.size(), 101u);
    EXPECT_EQ(scene.warnings.back(), "there are further warnings");
}

std::vector<std::byte> richGlb(const TemporaryFolder& folder) {
    const std::string text = richFile().text();
    writeFile(folder / "good.gltf", text);
    return exportedGlb(loadScene((folder / "good.gltf").string()));
}

TEST(GltfHostile, EveryTruncationIsAnError) {
    const TemporaryFolder folder;
    const std::vector<std::byte> glb = richGlb(folder);
    ASSERT_EQ(loadMessage(folder, glb, "cut.glb"), "no error");
    for (size_t size = 0; size < glb.size(); ++size)
        EXPECT_NE(loadMessage(folder, std::span(glb).first(size), "cut.glb"), "no error")
            << size << " of " << glb.size();
    const std::string text = richFile().text();
    for (size_t size = 0; size < text.size(); ++size)
        EXPECT_NE(loadMessage(folder, std::as_bytes(std::span(text)).first(size), "cut.gltf"), "no error")
            << size;
}

// Either the file loads or there is an InputError of one line; a crash or another exception fails the test.
void expectSurvives(const TemporaryFolder& folder, std::span<const std::byte> bytes, const char* name) {
    const std::string message = loadMessage(folder, bytes, name);
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST(GltfHostile, MutatedBytesDoNotCrash) {
    const TemporaryFolder folder;
    const std::vector<std::byte> glb = richGlb(folder);
    const std::string text = richFile().text();
    const std::span<const std::byte> plain = std::as_bytes(std::span(text));
    std::mt19937 random(1);
    for (int round = 0; round < 2000; ++round) {
        const bool binary = round % 2 == 0;
        std::vector<std::byte> bytes = binary ? glb : std::vector<std::byte>(plain.begin(), plain.end());
        const int changes = 1 + static_cast<int>(random() % 4);
        for (int i = 0; i < changes; ++i) bytes[random() % bytes.size()] = static_cast<std::byte>(random());
        expectSurvives(folder, bytes, binary ? "bent.glb" : "bent.gltf");
    }
}

// Replaces every number of the document, one after the other, by others that hurt.
TEST(GltfHostile, MutatedNumbersDoNotCrash) {
    const TemporaryFolder folder;
    const json good = json::parse(richFile().text());
    const json flat = good.flatten();
    const json hostile[] = {
        -1, 0, 1, 2, 3, 255, 65535, 2147483647, 4294967295, 9007199254740993, -1e308, 1e-300, "x", nullptr};
    for (const auto& [path, value] : flat.items()) {
        if (!value.is_number()) continue;
        for (const json& bad : hostile) {
            json document = good;
            document[json::json_pointer(path)] = bad;
            SCOPED_TRACE(path + " = " + bad.dump());
            const std::string text = document.dump();
            expectSurvives(folder, std::as_bytes(std::span(text)), "bent.gltf");
        }
    }
}

TEST(GltfHostile, MissingMembersDoNotCrash) {
    const TemporaryFolder folder;
    const json good = json::parse(richFile().text());
    std::function<void(const json&, const json::json_pointer&)> visit = [&](const json& value,
                                                                            const json::json_pointer& path) {
        for (const auto& [key, below] : value.items()) {
            const json::json_pointer at =
                value.is_array() ? path / static_cast<size_t>(std::stoul(key)) : path / key;
            json document = good;
            if (value.is_array())
                document[path].erase(static_cast<size_t>(std::stoul(key)));
            else
                document[path].erase(key);
            SCOPED_TRACE(at.to_string());
            const std::string text = document.dump();
            expectSurvives(folder, std::as_bytes(std::span(text)), "bent.gltf");
            if (below.is_structured()) visit(below, at);
        }
    };
    visit(good, json::json_pointer());
}

} // namespace
} // namespace kestrel
