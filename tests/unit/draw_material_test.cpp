// Materials in shaders: what a scene lacks is not compiled.
#include "draw/material_defines.h"
#include "shader/validate.h"
#include "support/folders.h"
#include <gtest/gtest.h>

namespace kestrel {
namespace {

ComposedProgram composeText(const std::string& text, const Defines& defines = {}) {
    ShaderLibrary library({test::sourceFolder() / "shaders"});
    library.addVirtual("test.comp", text);
    return compose({{"test.comp"}, defines, {}}, library);
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
