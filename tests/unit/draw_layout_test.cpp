// The blocks that C++ fills have the layout that GLSL reads.
#include "draw/material_defines.h"
#include "draw/view_data.h"
#include "shader/reflect.h"
#include "shader/validate.h"
#include "shared/scene.h"
#include "support/folders.h"
#include <cstddef>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using shared::LightRecord;
using shared::MaterialRecord;
using shared::TextureRecord;
using shared::VertexRecord;

ComposedProgram composeText(const std::string& text, const Defines& defines = {}) {
    ShaderLibrary library({test::sourceFolder() / "shaders"});
    library.addVirtual("test.comp", text);
    return compose({{"test.comp"}, defines, {}}, library);
}

void expectOffset(const ShaderResource& block, const std::string& member, size_t offset) {
    const BlockMember* found = block.member(member);
    ASSERT_NE(found, nullptr) << member;
    EXPECT_EQ(found->offset, offset) << member;
}

TEST(SharedLayout, Frame) {
    const Reflection reflection =
        reflect(composeText("#include \"lib/frame.glsl\"\n"
                            "layout(local_size_x = 1) in;\n"
                            "layout(std430) buffer Out { vec4 result; };\n"
                            "void main() { result = frame.sceneBounds + frame.time; }\n"));
    const ShaderResource* block = reflection.find("Frame");
    ASSERT_NE(block, nullptr);
    EXPECT_EQ(block->size, sizeof(FrameData));
    expectOffset(*block, "frame.size", offsetof(FrameData, size));
    expectOffset(*block, "frame.index", offsetof(FrameData, index));
    expectOffset(*block, "frame.seed", offsetof(FrameData, seed));
    expectOffset(*block, "frame.time", offsetof(FrameData, time));
    expectOffset(*block, "frame.sceneBounds", offsetof(FrameData, sceneBounds));
}

TEST(SharedLayout, View) {
    const Reflection reflection = reflect(composeText(
        "#include \"lib/view.glsl\"\n"
        "layout(local_size_x = 1) in;\n"
        "layout(std140) uniform DepthView { ViewData view; };\n"
        "layout(std430) buffer Out { vec4 result; };\n"
        "void main() { result = vec4(positionFromDepth(view, vec2(0), 0.5), view.farPlane); }\n"));
    const ShaderResource* block = reflection.find("DepthView");
    ASSERT_NE(block, nullptr);
    EXPECT_EQ(block->size, sizeof(ViewData));
    const std::pair<const char*, size_t> members[] = {
        {"view.view", offsetof(ViewData, view)},
        {"view.projection", offsetof(ViewData, projection)},
        {"view.viewProjection", offsetof(ViewData, viewProjection)},
        {"view.inverseView", offsetof(ViewData, inverseView)},
        {"view.inverseProjection", offsetof(ViewData, inverseProjection)},
        {"view.inverseViewProjection", offsetof(ViewData, inverseViewProjection)},
        {"view.previousViewProjection", offsetof(ViewData, previousViewProjection)},
        {"view.position", offsetof(ViewData, position)},
        {"view.size", offsetof(ViewData, size)},
        {"view.guard", offsetof(ViewData, guard)},
        {"view.divisor", offsetof(ViewData, divisor)},
        {"view.jitter", offsetof(ViewData, jitter)},
        {"view.nearPlane", offsetof(ViewData, nearPlane)},
        {"view.farPlane", offsetof(ViewData, farPlane)},
        {"view.corner", offsetof(ViewData, corner)},
        {"view.rightward", offsetof(ViewData, rightward)},
        {"view.upward", offsetof(ViewData, upward)},
        {"view.ahead", offsetof(ViewData, ahead)}};
    for (const auto& [member, offset] : members) expectOffset(*block, member, offset);
}

TEST(SharedLayout, SceneRecords) {
    const Reflection reflection = reflect(
        composeText("#include \"lib/material.glsl\"\n"
                    "#include \"lib/lights.glsl\"\n"
                    "layout(local_size_x = 1) in;\n"
                    "layout(std430) buffer SceneVertices { VertexRecord vertices[]; };\n"
                    "layout(std430) buffer Out { vec4 result; };\n"
                    "void main() {\n"
                    "    result = scene_materials[1].normalTexture.matrix + scene_lights[1].halfSize.x +\n"
                    "             vertices[1].colour;\n"
                    "}\n"));
    const ShaderResource* materials = reflection.find("Materials");
    const ShaderResource* lights = reflection.find("Lights");
    const ShaderResource* vertices = reflection.find("SceneVertices");
    ASSERT_TRUE(materials != nullptr && lights != nullptr && vertices != nullptr);

    const std::string m = "scene_materials[0].";
    EXPECT_EQ(materials->member(m + "baseColour")->topLevelStride, static_cast<int>(sizeof(MaterialRecord)));
    expectOffset(*materials, m + "baseColour", offsetof(MaterialRecord, baseColour));
    expectOffset(*materials, m + "emission", offsetof(MaterialRecord, emission));
    expectOffset(*materials, m + "metallic", offsetof(MaterialRecord, metallic));
    expectOffset(*materials, m + "roughness", offsetof(MaterialRecord, roughness));
    expectOffset(*materials, m + "normalScale", offsetof(MaterialRecord, normalScale));
    expectOffset(*materials, m + "alphaCutoff", offsetof(MaterialRecord, alphaCutoff));
    expectOffset(*materials, m + "flags", offsetof(MaterialRecord, flags));
    expectOffset(*materials, m + "transmission", offsetof(MaterialRecord, transmission));
    expectOffset(*materials, m + "ior", offsetof(MaterialRecord, ior));
    const std::pair<const char*, size_t> textures[] = {
        {"baseColourTexture", offsetof(MaterialRecord, baseColourTexture)},
        {"metallicRoughnessTexture", offsetof(MaterialRecord, metallicRoughnessTexture)},
        {"normalTexture", offsetof(MaterialRecord, normalTexture)},
        {"emissionTexture", offsetof(MaterialRecord, emissionTexture)}};
    for (const auto& [name, base] : textures) {
        const std::string t = m + name + ".";
        expectOffset(*materials, t + "matrix", base + offsetof(TextureRecord, matrix));
        expectOffset(*materials, t + "offset", base + offsetof(TextureRecord, offset));
        expectOffset(*materials, t + "place", base + offsetof(TextureRecord, place));
        expectOffset(*materials, t + "flags", base + offsetof(TextureRecord, flags));
        expectOffset(*materials, t + "source", base + offsetof(TextureRecord, source));
        expectOffset(*materials, t + "side", base + offsetof(TextureRecord, side));
    }

    const std::string l = "scene_lights[0].";
    expectOffset(*lights, "scene_light_count", 0);
    constexpr size_t records = 16; // where GpuScene puts the first record
    EXPECT_EQ(lights->member(l + "position")->topLevelStride, static_cast<int>(sizeof(LightRecord)));
    expectOffset(*lights, l + "position", records + offsetof(LightRecord, position));
    expectOffset(*lights, l + "kind", records + offsetof(LightRecord, kind));
    expectOffset(*lights, l + "direction", records + offsetof(LightRecord, direction));
    expectOffset(*lights, l + "range", records + offsetof(LightRecord, range));
    expectOffset(*lights, l + "intensity", records + offsetof(LightRecord, intensity));
    expectOffset(*lights, l + "cosInnerCone", records + offsetof(LightRecord, cosInnerCone));
    expectOffset(*lights, l + "tangent", records + offsetof(LightRecord, tangent));
    expectOffset(*lights, l + "cosOuterCone", records + offsetof(LightRecord, cosOuterCone));
    expectOffset(*lights, l + "bitangent", records + offsetof(LightRecord, bitangent));
    expectOffset(*lights, l + "halfSize", records + offsetof(LightRecord, halfSize));

    const std::string v = "vertices[0].";
    EXPECT_EQ(vertices->member(v + "normal")->topLevelStride, static_cast<int>(sizeof(VertexRecord)));
    expectOffset(*vertices, v + "tangent", offsetof(VertexRecord, tangent));
    expectOffset(*vertices, v + "texCoord", offsetof(VertexRecord, texCoord));
    expectOffset(*vertices, v + "texCoord1", offsetof(VertexRecord, texCoord1));
    expectOffset(*vertices, v + "colour", offsetof(VertexRecord, colour));
}

TEST(MaterialDefines, SayWhatTheSceneHas) {
    SceneFacts facts;
    EXPECT_TRUE(materialDefines(facts).empty());
    facts.hasTextures = true;
    facts.colourTextureArrays = 2;
    facts.hasMasked = true;
    EXPECT_EQ(materialDefines(facts), (Defines{{"MATERIAL_TEXTURES", "1"},
                                               {"MATERIAL_COLOUR_ARRAYS", "2"},
                                               {"MATERIAL_DATA_ARRAYS", "0"},
                                               {"MATERIAL_MASKED", "1"}}));
    facts.hasNormalMaps = true;
    facts.hasVertexColours = true;
    facts.hasTiledTextures = true;
    EXPECT_EQ(materialDefines(facts).size(), 7U);
}

TEST(MaterialDefines, EveryCombinationCompiles) {
    const std::string text =
        "#include \"lib/scene.glsl\"\n"
        "layout(local_size_x = 1) in;\n"
        "layout(std430) buffer Out { vec4 result; };\n"
        "void main() {\n"
        "    Surface s = sceneSurface(1u, vec2(0.25), vec3(0, 0, 1));\n"
        "    result = vec4(s.albedo + s.shadingNormal, sceneCovers(2u, vec2(0.5)) ? 1.0 : 0.0);\n"
        "}\n";
    auto choices = materialDefineChoices();
    choices["SCENE_BY_SAMPLER"] = {undefinedChoice, "1"};
    std::vector<Defines> all = allCombinations(choices);
    for (const auto& defines : allCombinations(
             {{"MATERIAL_MASKED", {undefinedChoice, "1"}}, {"MATERIAL_COLOURS", {undefinedChoice, "1"}}}))
        all.push_back(defines);
    for (const Defines& defines : all) {
        const auto problems = validate(composeText(text, defines));
        ASSERT_TRUE(problems.empty()) << problems.front().text();
    }
}

} // namespace
} // namespace kestrel
