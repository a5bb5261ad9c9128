// What shaders look up of a scene by number, as hits of rays do.
#include "draw/gpu_scene.h"
#include "draw/material_defines.h"
#include "gl_fixture.h"
#include "quads.h"
#include "reference/alpha_test.h"
#include <gtest/gtest.h>
#include <random>
#include <span>

namespace kestrel {
namespace {

using test::as;
using test::coloured;
using test::geometryOf;
using test::green;
using test::Quad;
using test::red;

class SceneLookupTest : public test::GlTest {};

TEST_F(SceneLookupTest, ComputeFindsTrianglesMaterialsAndLights) {
    Scene scene;
    scene.materials = {coloured(red), coloured(green)};
    GpuScene gpu(scene);
    Geometry geometry = geometryOf({{{-1, -1}, {0, 1}, 3, 0}, {{0, -1}, {1, 1}, 4, 1}});
    gpu.update(geometry);
    LightState light;
    light.kind = LightKind::Spot;
    light.intensity = {7, 8, 9};
    light.outerCone = 1;
    gpu.setLights({LightState{}, light});

    for (const bool bySampler : {false, true}) {
        Defines defines;
        if (bySampler) defines["SCENE_BY_SAMPLER"] = "1";
        const gl::Program program = test::computeProgram(
            "#include \"lib/scene.glsl\"\n"
            "#include \"lib/lights.glsl\"\n"
            "layout(local_size_x = 1) in;\n"
            "layout(std430) readonly buffer ScenePositions { vec4 positions[]; };\n"
            "layout(std430) readonly buffer SceneTriangles { uvec4 triangles[]; };\n"
            "layout(std430) writeonly buffer Result { vec4 result[]; };\n"
            "void main() {\n"
            "    Surface s = sceneSurface(2u, vec2(0.25, 0.25), vec3(0, 0, -1));\n"
            "    result[0] = vec4(s.position, s.front ? 1.0 : 0.0);\n"
            "    result[1] = vec4(s.albedo, float(s.material));\n"
            "    result[2] = vec4(s.normal, s.shadingNormal.z);\n"
            "    Surface behind = sceneSurface(2u, vec2(0.25, 0.25), vec3(0, 0, 1));\n"
            "    result[3] = vec4(behind.normal, behind.front ? 1.0 : 0.0);\n"
            "    result[4] = vec4(scene_lights[1].intensity, float(scene_light_count));\n"
            "    result[5] = vec4(positions[triangles[3].z].xyz, float(scene_lights[1].kind));\n"
            "    result[6] = vec4(float(scene_lights.length()), scene_lights[1].cosOuterCone, 0.0, 0.0);\n"
            "}\n",
            defines);
        for (const std::string& name : program.slotNames())
            EXPECT_TRUE(name == "Result" || name == "Frame" || GpuScene::reserves(name)) << name;
        gl::Buffer result(7 * 16, "result");
        program.use();
        gpu.bind(program);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, program.slot("Result")->unit, result.name());
        glDispatchCompute(1, 1, 1);
        const auto values = as<glm::vec4>(result.download());
        // Triangle 2 is the lower right one of the second quad: (0,-1) (1,-1) (1,1).
        EXPECT_EQ(values[0], glm::vec4(0.5F, -0.5F, 4, 1));
        EXPECT_EQ(values[1], glm::vec4(0, 1, 0, 1));
        EXPECT_EQ(values[2], glm::vec4(0, 0, 1, 1));
        EXPECT_EQ(values[3], glm::vec4(0, 0, -1, 0));
        EXPECT_EQ(values[4], glm::vec4(7, 8, 9, 2));
        EXPECT_EQ(values[5], glm::vec4(0, 1, 4, 1));
        EXPECT_EQ(values[6].x, 2);
        EXPECT_FLOAT_EQ(values[6].y, std::cos(1.0F));
    }
    EXPECT_TRUE(GpuScene::reserves("scene_first_triangle"));
    EXPECT_FALSE(GpuScene::reserves("depth"));
    EXPECT_GT(gpu.bytes(), 0U);
}

// The alpha test of rays against the reference's: every pair of wraps, filtered and not, transformed, either
// set of coordinates, factors and vertex colours, images of any size where no filter reads them.
TEST_F(SceneLookupTest, CutoutsAreThoseOfTheReference) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0, 1);
    Scene scene;
    for (const glm::ivec2 size : {glm::ivec2(8, 8), glm::ivec2(4, 4), glm::ivec2(5, 3)}) {
        TextureImage image{"alpha", size.x, size.y, {}};
        for (int i = 0; i < 4 * size.x * size.y; ++i)
            image.rgba.push_back(static_cast<std::uint8_t>(random() % 256));
        scene.images.push_back(image);
    }
    std::vector<Quad> quads;
    for (const Wrap s : {Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge})
        for (const Wrap t : {Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge})
            for (int image = -1; image < 3; ++image)
                for (const AlphaMode mode : {AlphaMode::Mask, AlphaMode::Blend}) {
                    Material material;
                    material.alphaMode = mode;
                    material.alphaCutoff = 0.35f;
                    material.baseColour.a = 0.9f;
                    material.baseColourTexture = {.image = image,
                                                  .texCoord = static_cast<int>(quads.size() % 2),
                                                  .wrapS = s,
                                                  .wrapT = t,
                                                  .nearest = image > 0,
                                                  .offset = {0.21f, -0.73f},
                                                  .scale = {3.3f, -2.7f},
                                                  .rotation = 0.4f};
                    scene.materials.push_back(material);
                    quads.push_back({{-1, -1},
                                     {1, 1},
                                     0,
                                     static_cast<std::uint32_t>(quads.size()),
                                     TriangleClass::MaskedDoubleSided});
                }
    scene.materials.push_back(coloured(red));
    quads.push_back(
        {{-1, -1}, {1, 1}, 0, static_cast<std::uint32_t>(quads.size())}); // comes first: nothing to test
    Geometry geometry = geometryOf(quads);
    for (VertexAttributes& vertex : geometry.attributes) vertex.colour.a = 0.7f + 0.3f * unit(random);
    GpuScene gpu(scene);
    gpu.update(geometry);
    SceneFacts facts;
    facts.hasTextures = facts.hasMasked = facts.hasVertexColours = true;
    facts.colourTextureArrays = 2;
    const std::uint32_t triangles = geometry.triangleCount();
    constexpr int samples = 256;
    std::vector<glm::vec2> weights;
    for (int i = 0; i < samples; ++i) {
        const float u = unit(random), v = unit(random);
        weights.emplace_back(u + v > 1 ? 1 - u : u, u + v > 1 ? 1 - v : v);
    }
    for (const bool bySampler : {false, true}) {
        Defines defines = materialDefines(facts);
        if (bySampler) defines["SCENE_BY_SAMPLER"] = "1";
        const gl::Program program = test::computeProgram(
            "#include \"lib/scene.glsl\"\n"
            "layout(local_size_x = 1) in;\n"
            "layout(std430) readonly buffer Weights { vec2 weights[]; };\n"
            "layout(std430) writeonly buffer Result { uint result[]; };\n"
            "void main() {\n"
            "    uint at = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;\n"
            "    result[at] = sceneCovers(gl_WorkGroupID.y, weights[gl_WorkGroupID.x]) ? 1u : 0u;\n"
            "}\n",
            defines);
        for (const std::string& name : program.slotNames())
            EXPECT_TRUE(name == "Result" || name == "Weights" || name == "Frame" || GpuScene::reserves(name))
                << name;
        gl::Buffer result(std::size_t{4} * samples * triangles, "result"), points(8 * samples, "points");
        points.upload(std::as_bytes(std::span(weights)));
        program.use();
        gpu.bind(program);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, program.slot("Result")->unit, result.name());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, program.slot("Weights")->unit, points.name());
        glDispatchCompute(samples, triangles, 1);
        const auto values = as<std::uint32_t>(result.download());
        const AlphaTest reference(geometry, scene);
        std::size_t at = 0, covered = 0, differ = 0;
        for (std::uint32_t triangle = 0; triangle < triangles; ++triangle)
            for (const glm::vec2& weight : weights) {
                covered += values[at];
                differ += (values[at++] != 0) != reference.isSolid(triangle, weight.x, weight.y);
            }
        EXPECT_GT(covered, values.size() / 3);
        EXPECT_LT(covered, values.size() * 5 / 6);
        // Sums in another order decide where alpha is the cutoff, and on which side of a texel's border a
        // point lies.
        EXPECT_LE(differ, values.size() / 2000) << (bySampler ? "by sampler" : "by image");
    }
}

TEST_F(SceneLookupTest, LightsAreExactlyThoseOfTheFrame) {
    const Scene scene;
    GpuScene gpu(scene);
    const gl::Program program =
        test::computeProgram("#include \"lib/lights.glsl\"\n"
                             "layout(local_size_x = 1) in;\n"
                             "layout(std430) writeonly buffer Result { uint result[]; };\n"
                             "void main() { result[0] = scene_light_count;\n"
                             "              result[1] = uint(scene_lights.length()); }\n");
    for (const size_t count : {0U, 3U, 1U}) {
        gpu.setLights(std::vector<LightState>(count));
        gl::Buffer result(8, "result");
        program.use();
        gpu.bind(program);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, program.slot("Result")->unit, result.name());
        glDispatchCompute(1, 1, 1);
        const auto number = static_cast<std::uint32_t>(count);
        EXPECT_EQ(as<std::uint32_t>(result.download()), (std::vector<std::uint32_t>{number, number}));
    }
}

} // namespace
} // namespace kestrel
