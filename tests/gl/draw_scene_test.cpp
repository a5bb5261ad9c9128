#include "draw/draw_calls.h"
#include "draw/gpu_scene.h"
#include "draw/material_defines.h"
#include "gl_fixture.h"
#include "quads.h"
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using test::blue;
using test::coloured;
using test::composeTexts;
using test::geometryOf;
using test::green;
using test::Quad;
using test::red;

const std::vector<TriangleClass> allClasses = {TriangleClass::Opaque, TriangleClass::OpaqueDoubleSided,
                                               TriangleClass::Masked, TriangleClass::MaskedDoubleSided};

// Draws into 8x8 pixels, whose corners are -1 and 1, seen from +z: nearer is greater z.
class DrawSceneTest : public test::GlTest {
protected:
    static constexpr std::uint32_t side = 8;

    // The scene's base colours (not numbered otherwise) or what `expression` makes of a fragment.
    Image draw(GpuScene& gpu, const SceneFacts& facts, const DrawState& state = {},
               const std::vector<TriangleClass>& classes = allClasses,
               const std::string& expression = "point.baseColour", const std::string& previous = "") {
        const std::string vertex =
            "#include \"lib/vertex.glsl\"\n"
            "out vec2 first; out vec2 second; out vec4 colour; out vec3 normal; out vec4 tangent;\n"
            "void main() {\n"
            "    first = in_tex_coord; second = in_tex_coord1; colour = in_colour;\n"
            "    normal = in_normal; tangent = in_tangent;\n"
            "    vec3 position = " +
            (previous.empty() ? std::string("in_position") : previous) +
            ";\n"
            "    gl_Position = vec4(position.xy, 0.5 + 0.25 * position.z, 1.0);\n"
            "}\n";
        const std::string fragment =
            "#include \"lib/fragment.glsl\"\n"
            "in vec2 first; in vec2 second; in vec4 colour; in vec3 normal; in vec4 tangent;\n"
            "out vec4 out_colour;\n"
            "void main() {\n"
            "    TexCoords coords = fragmentTexCoords(first, second);\n"
            "    uint material = fragmentMaterial();\n"
            "    if (!materialCovers(material, first, second, colour.a)) discard;\n"
            "    MaterialSample point = materialAt(material, coords, colour);\n"
            "    vec3 bent = materialNormal(material, coords, normal, tangent);\n"
            "    out_colour = " +
            expression + " + 0.0 * vec4(bent, 0.0);\n}\n";
        const gl::Program program(
            composeTexts({{"t.vert", vertex}, {"t.frag", fragment}}, materialDefines(facts)), {"colour"},
            test::context().capabilities());
        gl::Texture colour(Desc::texture2D(Format::RGBA32F, {side, side, 1}), "colour");
        gl::Texture depth(Desc::texture2D(Format::D32F, {side, side, 1}), "depth");
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffers_.get({{&colour}}, {&depth}, {}));
        setViewport({side, side});
        program.use();
        gpu.bind(program);
        gpu.draw(state, classes, program);
        return colour.downloadImage();
    }

    static glm::vec4 pixel(const Image& image, int x, int y) {
        return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2), image.at(x, y, 3)};
    }

private:
    gl::FramebufferCache framebuffers_;
};

const glm::vec4 nothing(0);

TEST_F(DrawSceneTest, AnEmptySceneDrawsNothing) {
    const Scene scene;
    GpuScene gpu(scene);
    EXPECT_EQ(pixel(draw(gpu, {}), 3, 3), nothing);
    gpu.update(Geometry{});
    EXPECT_EQ(pixel(draw(gpu, {}), 3, 3), nothing);
    EXPECT_EQ(gpu.triangleCount(), 0U);
}

TEST_F(DrawSceneTest, EachTriangleHasItsMaterialAndTheNearestWins) {
    Scene scene;
    scene.materials = {coloured(red), coloured(green), coloured(blue)};
    GpuScene gpu(scene);
    // Left half red, right half green, in the middle blue in front; the last one, behind, is hidden.
    gpu.update(geometryOf({{{-1, -1}, {0, 1}, 0, 0},
                           {{0, -1}, {1, 1}, 0, 1, TriangleClass::OpaqueDoubleSided},
                           {{-0.5, -0.5}, {0.5, 0.5}, 1, 2},
                           {{-1, -1}, {1, 1}, -1, 2, TriangleClass::OpaqueDoubleSided}}));
    EXPECT_EQ(gpu.triangleCount(), 8U);
    const Image image = draw(gpu, {});
    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x) {
            const bool middle = x >= 2 && x < 6 && y >= 2 && y < 6;
            EXPECT_EQ(pixel(image, x, y), middle ? blue : x < 4 ? red : green) << x << ", " << y;
        }
    }
}

TEST_F(DrawSceneTest, OnlySingleSidedClassesAreCulled) {
    Scene scene;
    scene.materials = {coloured(red), coloured(green)};
    GpuScene gpu(scene);
    gpu.update(geometryOf({{{-1, -1}, {0, 1}, 0, 0, TriangleClass::Opaque, true},
                           {{0, -1}, {1, 1}, 0, 1, TriangleClass::OpaqueDoubleSided, true}}));
    const Image back = draw(gpu, {});
    EXPECT_EQ(pixel(back, 1, 4), nothing);
    EXPECT_EQ(pixel(back, 6, 4), green);
    const Image front = draw(gpu, {}, {.cull = Cull::Front});
    EXPECT_EQ(pixel(front, 1, 4), red);
    EXPECT_EQ(pixel(front, 6, 4), green);
    const Image single = draw(gpu, {}, {.cull = Cull::None}, {TriangleClass::Opaque});
    EXPECT_EQ(pixel(single, 1, 4), red);
    EXPECT_EQ(pixel(single, 6, 4), nothing);
}

TEST_F(DrawSceneTest, StateIsSetAnewForEachDraw) {
    Scene scene;
    scene.materials = {coloured({0.25F, 0, 0, 1}), coloured({0.5F, 0, 0, 1})};
    GpuScene gpu(scene);
    gpu.update(geometryOf({{{-1, -1}, {1, 1}, 0, 0}, {{-1, -1}, {1, 1}, 1, 1}}));
    EXPECT_EQ(pixel(draw(gpu, {}, {.depth = Compare::Always, .blend = Blend::Add}), 4, 4).r, 0.75F);
    EXPECT_EQ(pixel(draw(gpu, {}, {.colourWrite = false}), 4, 4), nothing);
    EXPECT_EQ(pixel(draw(gpu, {}, {.depth = Compare::Always, .depthWrite = false}), 4, 4).r, 0.5F);
    EXPECT_EQ(pixel(draw(gpu, {}, {.depth = Compare::Less}), 4, 4),
              nothing); // nothing is farther than the clear
    EXPECT_EQ(pixel(draw(gpu, {}), 4, 4).r, 0.5F);
}

TEST_F(DrawSceneTest, PreviousPositionsAreThoseOfTheLastFrameOrOfThisOne) {
    Scene scene;
    scene.materials = {coloured(red)};
    GpuScene gpu(scene);
    Geometry geometry = geometryOf({{{-1, -1}, {0, 1}, 0, 0}});
    gpu.update(geometry);
    const auto drawPrevious = [&] {
        return draw(gpu, {}, {}, allClasses, "point.baseColour", "in_previous_position");
    };
    EXPECT_EQ(pixel(drawPrevious(), 1, 4), red);
    EXPECT_EQ(pixel(drawPrevious(), 6, 4), nothing);
    geometry.previousPositions = geometry.positions;
    for (glm::vec3& position : geometry.previousPositions) position.x += 1;
    gpu.update(geometry);
    EXPECT_EQ(pixel(drawPrevious(), 1, 4), nothing);
    EXPECT_EQ(pixel(drawPrevious(), 6, 4), red);
    EXPECT_EQ(pixel(draw(gpu, {}), 1, 4), red);
    geometry.previousPositions.clear();
    gpu.update(geometry);
    EXPECT_EQ(pixel(drawPrevious(), 1, 4), red);
}

TEST_F(DrawSceneTest, WhatMovesIsSentAgainAndNothingElse) {
    Scene scene;
    scene.materials = {coloured(red), coloured(green)};
    GpuScene gpu(scene);
    Geometry geometry = geometryOf({{{-1, -1}, {-0.5f, 1}, 0, 0}, {{0.5f, -1}, {1, 1}, 0, 1}});
    geometry.moving = {{4, 4}};
    gpu.update(geometry);
    EXPECT_EQ(pixel(draw(gpu, {}), 0, 4), red);
    EXPECT_EQ(pixel(draw(gpu, {}), 7, 4), green);
    for (glm::vec3& position : geometry.positions)
        position.x *= 0.5f; // that of the first is not to be looked at
    gpu.update(geometry);
    EXPECT_EQ(pixel(draw(gpu, {}), 0, 4), red);
    EXPECT_EQ(pixel(draw(gpu, {}), 7, 4), nothing);
    EXPECT_EQ(pixel(draw(gpu, {}), 5, 4), green);
}

TEST_F(DrawSceneTest, TrianglesThatAreTurnedOverKeepTheirFront) {
    Scene scene;
    scene.materials = {coloured(red)};
    GpuScene gpu(scene);
    gpu.update(geometryOf({{{-1, -1}, {1, 1}}}));
    EXPECT_EQ(pixel(draw(gpu, {}), 4, 4), red);
    Geometry turned = geometryOf({{{1, -1}, {-1, 1}, 0, 0, TriangleClass::Opaque, true}});
    turned.turns = 1;
    gpu.update(turned);
    EXPECT_EQ(pixel(draw(gpu, {}), 4, 4), red);
}

TEST_F(DrawSceneTest, VertexColoursCountWhereTheSceneHasThem) {
    Scene scene;
    scene.materials = {coloured({1, 1, 0.5F, 1})};
    GpuScene gpu(scene);
    gpu.update(geometryOf({{{-1, -1}, {1, 1}}}));
    EXPECT_EQ(pixel(draw(gpu, {}), 0, 7), glm::vec4(1, 1, 0.5F, 1));
    SceneFacts facts;
    facts.hasVertexColours = true;
    const glm::vec4 corner =
        pixel(draw(gpu, facts), 0, 7); // the pixel's centre is 1/16 in from the lower left
    EXPECT_NEAR(corner.r, 0.0625F, 1e-6F);
    EXPECT_NEAR(corner.g, 0.0625F, 1e-6F);
    EXPECT_EQ(corner.b, 0.5F);
}

// ---- textures

TextureImage imageOf(int width, int height, const std::vector<glm::u8vec4>& texels) {
    TextureImage image{"image", width, height, {}};
    for (const glm::u8vec4& texel : texels)
        for (int c = 0; c < 4; ++c) image.rgba.push_back(texel[c]);
    return image;
}

class TexturedSceneTest : public DrawSceneTest {
protected:
    // One quad over the whole target with one material whose base colour is the image.
    Image drawTextured(TextureImage image, const TextureRef& reference, const Material& base = {}) {
        Scene scene;
        scene.images = {std::move(image)};
        Material material = base;
        material.baseColourTexture = reference;
        scene.materials = {material};
        SceneFacts facts;
        facts.hasTextures = true;
        facts.colourTextureArrays = 1;
        facts.hasMasked = material.alphaMode != AlphaMode::Opaque;
        GpuScene gpu(scene);
        gpu.update(geometryOf({{{-1, -1}, {1, 1}}}));
        return draw(gpu, facts);
    }
    static TextureRef reference() {
        TextureRef result;
        result.image = 0;
        result.nearest = true;
        return result;
    }
};

const glm::u8vec4 black8(0, 0, 0, 255), white8(255), red8(255, 0, 0, 255), green8(0, 255, 0, 255),
    blue8(0, 0, 255, 255);
const glm::vec4 white(1), black(0, 0, 0, 1);

TEST_F(TexturedSceneTest, TheFirstRowIsTheTop) {
    const Image image = drawTextured(imageOf(2, 2, {red8, green8, blue8, white8}), reference());
    EXPECT_EQ(pixel(image, 1, 1), red);
    EXPECT_EQ(pixel(image, 6, 1), green);
    EXPECT_EQ(pixel(image, 1, 6), blue);
    EXPECT_EQ(pixel(image, 6, 6), white);
}

TEST_F(TexturedSceneTest, ColoursAreDecodedFromSrgb) {
    const Image image = drawTextured(imageOf(1, 1, {{188, 188, 188, 128}}), reference());
    EXPECT_NEAR(pixel(image, 4, 4).r, srgbToLinear(188.0F / 255), 2e-3F);
    EXPECT_NEAR(pixel(image, 4, 4).a, 128.0F / 255, 1e-3F);
}

TEST_F(TexturedSceneTest, TransformMovesScalesAndTurns) {
    const TextureImage quarters = imageOf(2, 2, {red8, green8, blue8, white8});
    TextureRef moved = reference();
    moved.offset = {0.5F, 0};
    EXPECT_EQ(pixel(drawTextured(quarters, moved), 1, 1), green);
    TextureRef scaled = reference();
    scaled.scale = {2, 2};
    const Image repeated = drawTextured(quarters, scaled);
    EXPECT_EQ(pixel(repeated, 0, 0), red);
    EXPECT_EQ(pixel(repeated, 2, 0), green);
    EXPECT_EQ(pixel(repeated, 4, 0), red);
    EXPECT_EQ(pixel(repeated, 7, 7), white);
    // A quarter turn of the coordinates counter-clockwise, seen with v downwards: (u, v) becomes (v, -u), so
    // the image turns clockwise.
    TextureRef turned = reference();
    turned.rotation = 1.5707964F;
    const Image image = drawTextured(quarters, turned);
    EXPECT_EQ(pixel(image, 1, 1), blue);
    EXPECT_EQ(pixel(image, 6, 1), red);
    EXPECT_EQ(pixel(image, 6, 6), green);
    EXPECT_EQ(pixel(image, 1, 6), white);
}

TEST_F(TexturedSceneTest, EachAxisWrapsInItsOwnWay) {
    const TextureImage halves = imageOf(2, 1, {black8, white8});
    const auto row = [&](Wrap wrap) {
        TextureRef wrapped = reference();
        wrapped.wrapS = wrap;
        wrapped.scale = {4, 1};
        wrapped.offset = {-1, 0}; // u from -1 to 3 over 8 pixels: two pixels a repeat
        const Image image = drawTextured(halves, wrapped);
        std::string result;
        for (int x = 0; x < 8; ++x) result += pixel(image, x, 4).r > 0.5F ? 'w' : 'b';
        return result;
    };
    EXPECT_EQ(row(Wrap::Repeat), "bwbwbwbw");
    EXPECT_EQ(row(Wrap::MirroredRepeat), "wbbwwbbw");
    EXPECT_EQ(row(Wrap::ClampToEdge), "bbbwwwww");
}

TEST_F(TexturedSceneTest, TheSecondTextureCoordinatesCanBeChosen) {
    TextureRef second = reference();
    second.texCoord = 1; // upside down in this geometry
    const Image image = drawTextured(imageOf(1, 2, {red8, blue8}), second);
    EXPECT_EQ(pixel(image, 4, 1), blue);
    EXPECT_EQ(pixel(image, 4, 6), red);
}

TEST_F(TexturedSceneTest, OddSizesKeepTheirTexels) {
    const Image image = drawTextured(imageOf(3, 1, {red8, green8, blue8}), reference());
    EXPECT_EQ(pixel(image, 0, 4), red);
    EXPECT_EQ(pixel(image, 4, 4), green);
    EXPECT_EQ(pixel(image, 7, 4), blue);
}

TEST_F(TexturedSceneTest, LinearTexturesAreFilteredAndMinifiedByTheirMips) {
    TextureRef smooth = reference();
    smooth.nearest = false;
    smooth.wrapS = Wrap::ClampToEdge;
    const Image ramp = drawTextured(imageOf(2, 1, {black8, white8}), smooth);
    EXPECT_EQ(pixel(ramp, 0, 4).r, 0);
    EXPECT_EQ(pixel(ramp, 7, 4).r, 1);
    EXPECT_GT(pixel(ramp, 4, 4).r, 0.5F);
    EXPECT_LT(pixel(ramp, 4, 4).r, 0.7F);
    // 64 texels over 8 pixels of a one-texel checkerboard: the mean in linear light.
    std::vector<glm::u8vec4> checker;
    for (int i = 0; i < 64 * 64; ++i) checker.push_back((i + i / 64) % 2 == 0 ? black8 : white8);
    smooth.wrapS = Wrap::Repeat;
    const Image mean = drawTextured(imageOf(64, 64, checker), smooth);
    for (int x = 0; x < 8; ++x) EXPECT_NEAR(pixel(mean, x, 4).r, 0.5F, 0.01F);
}

TEST_F(TexturedSceneTest, MaskedTexelsBelowTheCutoffAreHoles) {
    Material masked;
    masked.alphaMode = AlphaMode::Mask;
    masked.alphaCutoff = 0.4F;
    const TextureImage image = imageOf(2, 1, {{255, 255, 255, 90}, {255, 255, 255, 110}});
    const Image drawn = drawTextured(image, reference(), masked);
    EXPECT_EQ(pixel(drawn, 1, 4), nothing);
    EXPECT_EQ(pixel(drawn, 6, 4).r, 1);
    masked.baseColour.a = 0.9F; // 110 / 255 * 0.9 is below
    EXPECT_EQ(pixel(drawTextured(image, reference(), masked), 6, 4), nothing);
    masked.alphaMode = AlphaMode::Opaque;
    EXPECT_EQ(pixel(drawTextured(image, reference(), masked), 1, 4).r, 1);
}

TEST_F(TexturedSceneTest, EveryArrayIsReachedAndEveryKindOfTexture) {
    Scene scene;
    // Five sizes in four arrays; each image one colour; every image is used as colour, and as data.
    const glm::u8vec4 colours[] = {red8, green8, blue8, white8, {255, 255, 0, 255}};
    const int sides[] = {1, 4, 16, 64, 256};
    std::vector<Quad> quads;
    for (int i = 0; i < 5; ++i) {
        const auto index = static_cast<size_t>(i);
        scene.images.push_back(
            imageOf(sides[i], sides[i],
                    std::vector<glm::u8vec4>(static_cast<size_t>(sides[i] * sides[i]), colours[i])));
        Material material;
        material.baseColourTexture.image = i;
        material.emissionTexture.image = 4 - i;
        material.emission = {1, 1, 1};
        material.metallicRoughnessTexture.image = i;
        material.metallic = 0.5F;
        material.roughness = 0.25F;
        scene.materials.push_back(material);
        const float x = -1 + 0.25F * static_cast<float>(i);
        quads.push_back({{x, -1}, {x + 0.25F, 1}, 0, static_cast<std::uint32_t>(index)});
    }
    EXPECT_EQ(textureArrays(scene, TextureRole::Colour).arrays.size(), size_t{maxTextureArrays});
    const SceneFacts facts = [&] {
        SceneFacts result;
        result.hasTextures = true;
        result.colourTextureArrays = result.dataTextureArrays = maxTextureArrays;
        return result;
    }();
    GpuScene gpu(scene);
    gpu.update(geometryOf(quads));
    const Image base = draw(gpu, facts);
    const Image emission = draw(gpu, facts, {}, allClasses, "vec4(point.emission, 1.0)");
    const Image surface = draw(gpu, facts, {}, allClasses, "vec4(point.metallic, point.roughness, 0.0, 1.0)");
    for (int i = 0; i < 5; ++i) {
        SCOPED_TRACE(i);
        EXPECT_EQ(pixel(base, i, 3), glm::vec4(colours[i]) / 255.0F);
        EXPECT_EQ(glm::vec3(pixel(emission, i, 3)), glm::vec3(colours[4 - i]) / 255.0F);
        EXPECT_EQ(pixel(surface, i, 3).r, 0.5F * static_cast<float>(colours[i].b) / 255);
        EXPECT_EQ(pixel(surface, i, 3).g, 0.25F * static_cast<float>(colours[i].g) / 255);
    }
}

// More images than an array has layers: several share a layer, and each shows itself alone, with its own
// wrapping.
TEST_F(TexturedSceneTest, ImagesThatShareALayerLookAsIfEachHadOne) {
    constexpr int count = 2100; // 2048 layers are what a device must have
    Scene scene;
    for (int i = 0; i < count; ++i) {
        const auto level = static_cast<std::uint8_t>(i % 251);
        scene.images.push_back(imageOf(
            2, 2, {{level, 0, 0, 255}, {0, level, 0, 255}, {0, 0, level, 255}, {level, level, level, 255}}));
        Material material;
        material.baseColourTexture.image = i;
        scene.materials.push_back(material);
    }
    const TextureArrays layout = textureArrays(scene, TextureRole::Colour);
    ASSERT_TRUE(layout.tiled());
    std::vector<TextureRef> references;
    for (const int image : {1, 700, 2099})
        for (const bool nearest : {true, false})
            for (const Wrap wrap : {Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge}) {
                TextureRef reference;
                reference.image = image;
                reference.nearest = nearest;
                reference.wrapS = reference.wrapT = wrap;
                reference.scale = {3.3F, 2.7F};
                reference.offset = {-1.2F, -0.9F};
                references.push_back(reference);
            }
    SceneFacts single;
    single.hasTextures = true;
    single.colourTextureArrays = 1;
    SceneFacts shared = single;
    shared.hasTiledTextures = true;
    for (const TextureRef& reference : references) {
        SCOPED_TRACE(testing::Message() << "image " << reference.image << ", wrap " << int(reference.wrapS)
                                        << (reference.nearest ? ", nearest" : ", linear"));
        Scene one;
        one.images = {scene.images[static_cast<size_t>(reference.image)]};
        one.materials.resize(1);
        one.materials[0].baseColourTexture = reference;
        one.materials[0].baseColourTexture.image = 0;
        scene.materials[0].baseColourTexture = reference;
        GpuScene gpuOne(one), gpuAll(scene);
        gpuOne.update(geometryOf({{{-1, -1}, {1, 1}}}));
        gpuAll.update(geometryOf({{{-1, -1}, {1, 1}}}));
        const Image wanted = draw(gpuOne, single), image = draw(gpuAll, shared);
        // The driver's own filter has 8 bits of a texel's width, here up to 1/256 of the step between two
        // texels.
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                for (int c = 0; c < 4; ++c)
                    ASSERT_NEAR(image.at(x, y, c), wanted.at(x, y, c), reference.nearest ? 1e-6F : 0.006F)
                        << x << ", " << y << ", " << c;
    }
}

TEST_F(TexturedSceneTest, NormalMapsBendAlongTangentAndBitangent) {
    Scene scene;
    scene.images = {imageOf(1, 1, {{255, 128, 128, 255}}), imageOf(1, 1, {{128, 255, 128, 255}})};
    for (int i = 0; i < 2; ++i) {
        Material material;
        material.normalTexture.image = i;
        scene.materials.push_back(material);
    }
    SceneFacts facts;
    facts.hasTextures = facts.hasNormalMaps = true;
    facts.dataTextureArrays = 1;
    GpuScene gpu(scene);
    gpu.update(geometryOf({{{-1, -1}, {0, 1}, 0, 0}, {{0, -1}, {1, 1}, 0, 1}}));
    const Image image = draw(gpu, facts, {}, allClasses, "vec4(bent, 1.0)");
    // The normal is +z, the tangent +x with positive handedness: the bitangent is +y. 128 is a little over 0.
    EXPECT_GT(pixel(image, 1, 4).x, 0.999F);
    EXPECT_GT(pixel(image, 6, 4).y, 0.999F);
    EXPECT_NEAR(glm::length(glm::vec3(pixel(image, 1, 4))), 1, 1e-5F);
}

} // namespace
} // namespace kestrel
