#include "core/error.h"
#include "gl/debug_output.h"
#include "gl_fixture.h"
#include "graph/memory.h"
#include <gmock/gmock.h>
#include <limits>
#include <numeric>

namespace kestrel {
namespace {

using test::as;
using test::messageOf;
using ::testing::Each;
using ::testing::HasSubstr;

class ObjectsTest : public test::GlTest {};

std::vector<Format> allFormats() {
    std::vector<Format> formats;
    for (int i = 1; i < static_cast<int>(Format::Count); ++i) formats.push_back(static_cast<Format>(i));
    return formats;
}

// Texels that every format holds exactly: small numbers as bytes of unorm, floats, halves or integers.
std::vector<std::byte> patternOf(Format format, size_t texels) {
    const FormatInfo& info = formatInfo(format);
    std::vector<std::byte> bytes(texels * static_cast<size_t>(info.bytes));
    const size_t components = texels * static_cast<size_t>(info.channels);
    const size_t size = bytes.size() / components;
    const bool floats = !info.integer && size > 1;
    for (size_t i = 0; i < components; ++i) {
        if (floats && size == 4) {
            const float value = static_cast<float>(i) / 1024;
            std::memcpy(bytes.data() + 4 * i, &value, 4);
        } else if (floats) {
            const auto half = static_cast<std::uint16_t>(0x3c00 + i); // 1 and what follows
            std::memcpy(bytes.data() + 2 * i, &half, 2);
        } else {
            const auto number = static_cast<std::uint32_t>(7 * i + 1);
            std::memcpy(bytes.data() + size * i, &number, size);
        }
    }
    return bytes;
}

TEST(CutText, EndsBetweenCharacters) {
    EXPECT_EQ(gl::cutText("abc", 3), "abc");
    EXPECT_EQ(gl::cutText("abcd", 3), "abc");
    EXPECT_EQ(gl::cutText("ab\u00e9", 3), "ab"); // two bytes, of which one would fit
    EXPECT_EQ(gl::cutText("ab\u00e9", 4), "ab\u00e9");
    EXPECT_EQ(gl::cutText("\u20ac", 2), "");
    EXPECT_EQ(gl::cutText("abc", 0), "");
}

// The fixture holds that no GL error comes up.
TEST_F(ObjectsTest, LabelsOfAnyLengthAreTakenAsFarAsTheDriverDoes) {
    GLint most = 0, mostOfGroup = 0;
    glGetIntegerv(GL_MAX_LABEL_LENGTH, &most);
    glGetIntegerv(GL_MAX_DEBUG_MESSAGE_LENGTH, &mostOfGroup);
    for (const GLint length : {most - 1, most, 10 * most}) {
        const std::string label(static_cast<size_t>(length), 'x');
        const gl::Texture texture(Desc::texture2D(Format::R8, {2, 2, 1}), label);
        const gl::Buffer buffer(64, label);
        EXPECT_NE(buffer.texelView(Format::R32F), 0U);
        const gl::VertexArray none(label);
        std::vector<char> held(static_cast<size_t>(most) + 1);
        GLsizei size = 0;
        glGetObjectLabel(GL_TEXTURE, texture.name(), most, &size, held.data());
        EXPECT_EQ(size, most - 1);
        const std::string file = label.substr(0, static_cast<size_t>(std::min(length, 200))) + ".comp";
        const gl::Program program(test::composeTexts({
                                      {file, "layout(local_size_x = 1) in;\nvoid main() {}\n"},
                                  }),
                                  {}, test::context().capabilities());
        EXPECT_NE(program.name(), 0U);
    }
    for (const GLint length : {mostOfGroup - 1, mostOfGroup, 3 * mostOfGroup}) {
        gl::pushDebugGroup(0, std::string(static_cast<size_t>(length), 'x'));
        glPopDebugGroup();
    }
}

TEST_F(ObjectsTest, TexelsOfEveryFormatComeBack) {
    const Extent extent{5, 3, 1}; // rows of no multiple of 4 bytes
    for (const Format format : allFormats()) {
        SCOPED_TRACE(formatInfo(format).name);
        gl::Texture texture(Desc::texture2D(format, extent), "round iteration");
        EXPECT_THAT(texture.download(), Each(std::byte{0}));
        const std::vector<std::byte> pattern = patternOf(format, 15);
        texture.upload(std::span(pattern));
        EXPECT_EQ(texture.download(), pattern);
    }
}

TEST_F(ObjectsTest, ImagesOfEveryFormatComeBackTopRowFirst) {
    for (const Format format : allFormats()) {
        const FormatInfo& info = formatInfo(format);
        SCOPED_TRACE(info.name);
        gl::Texture texture(Desc::texture2D(format, {3, 2, 1}), "image");
        Image image(3, 2, info.channels);
        // 0 and 1 are exact in every format.
        for (size_t i = 0; i < image.values.size(); ++i) image.values[i] = i % 3 == 0 ? 1.0F : 0.0F;
        texture.uploadImage(image);
        EXPECT_EQ(texture.downloadImage(), image);
    }
    gl::Texture texture(Desc::texture2D(Format::R32F, {1, 2, 1}), "rows");
    Image image(1, 2, 1);
    image.at(0, 0) = 5; // top
    image.at(0, 1) = 6;
    texture.uploadImage(image);
    EXPECT_EQ(as<float>(texture.download()), (std::vector<float>{6, 5}));
}

TEST_F(ObjectsTest, LayersSlicesAndFacesAreTheirOwn) {
    Desc cube = Desc::texture2D(Format::R32UI, {2, 2, 1});
    cube.kind = ResourceKind::TextureCube;
    const Desc descs[] = {Desc::array2D(Format::R32UI, {2, 2, 3}), Desc::texture3D(Format::R32UI, {2, 2, 3}),
                          cube};
    for (const Desc& desc : descs) {
        SCOPED_TRACE(describe(desc));
        gl::Texture texture(desc, "layers");
        ASSERT_EQ(texture.layers(), desc.kind == ResourceKind::TextureCube ? 6U : 3U);
        for (std::uint32_t layer = 0; layer < texture.layers(); ++layer) {
            const std::vector<std::uint32_t> texels(4, layer + 1);
            texture.upload(std::as_bytes(std::span(texels)), static_cast<int>(layer));
        }
        EXPECT_EQ(as<std::uint32_t>(texture.download(1)), std::vector<std::uint32_t>(4, 2));
        const auto all = as<std::uint32_t>(texture.download(-1));
        ASSERT_EQ(all.size(), 4 * texture.layers());
        for (size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i], i / 4 + 1);
    }
}

TEST_F(ObjectsTest, MipsAreMadeAndReadSingly) {
    Desc desc = Desc::texture2D(Format::R32F, {4, 4, 1});
    desc.mips = 3;
    gl::Texture texture(desc, "mips");
    std::vector<float> texels(16);
    std::iota(texels.begin(), texels.end(), 0.0F);
    texture.upload(std::as_bytes(std::span(texels)));
    texture.generateMips();
    EXPECT_EQ(as<float>(texture.download(0, 2)), std::vector<float>{7.5F});
    EXPECT_EQ(as<float>(texture.download(0, 1)), (std::vector<float>{2.5F, 4.5F, 10.5F, 12.5F}));
    EXPECT_EQ(texture.extentOf(1), (Extent{2, 2, 1}));
    texture.clear(glm::vec4(3));
    EXPECT_EQ(as<float>(texture.download(0, 2)), std::vector<float>{3});
}

TEST_F(ObjectsTest, ClearsClampIntegersToTheirFormat) {
    const auto cleared = [](Format format, float value) {
        gl::Texture texture(Desc::texture2D(format, {1, 1, 1}), "clear");
        texture.clear(glm::vec4(value));
        auto bytes = texture.download();
        bytes.resize(16);
        return as<std::uint32_t>(bytes)[0];
    };
    EXPECT_EQ(cleared(Format::R32UI, 4294967296.0F), 0xffffffffU);
    EXPECT_EQ(cleared(Format::R32UI, -1.0F), 0U);
    EXPECT_EQ(cleared(Format::R32I, -1.0F), 0xffffffffU);
    EXPECT_EQ(cleared(Format::R32I, -1e20F), 0x80000000U);
    EXPECT_EQ(cleared(Format::R8UI, 300.0F), 255U);
    EXPECT_EQ(cleared(Format::R16UI, 65536.0F), 65535U);
    EXPECT_EQ(cleared(Format::R8, 0.5F), 128U);
    EXPECT_EQ(cleared(Format::D32F, 0.5F), 0x3f000000U);
    EXPECT_EQ(cleared(Format::R32UI, std::numeric_limits<float>::quiet_NaN()), 0U);
}

TEST_F(ObjectsTest, BuffersHoldBytesAndAreZeroAtFirst) {
    gl::Buffer buffer(40, "bytes");
    EXPECT_THAT(buffer.download(), Each(std::byte{0}));
    const std::vector<std::uint32_t> words = {1, 2, 3};
    buffer.upload(std::as_bytes(std::span(words)), 8);
    EXPECT_EQ(as<std::uint32_t>(buffer.download(4, 16)), (std::vector<std::uint32_t>{0, 1, 2, 3}));
    buffer.clear(9);
    EXPECT_EQ(as<std::uint32_t>(buffer.download()), std::vector<std::uint32_t>(10, 9));
    gl::Buffer copy(40, "copy");
    gl::copyResource(buffer, copy);
    EXPECT_EQ(copy.download(), buffer.download());
    gl::Buffer hollow(0, "hollow");
    EXPECT_TRUE(hollow.download().empty());
    EXPECT_EQ(buffer.texelView(Format::R32UI), buffer.texelView(Format::R32UI));
    EXPECT_NE(buffer.texelView(Format::R32UI), buffer.texelView(Format::R32F));
}

TEST_F(ObjectsTest, ARangeIsABufferOfItsOwn) {
    gl::Buffer whole(1024, "whole");
    {
        gl::Buffer range = whole.range(256, 260);
        EXPECT_EQ(range.name(), whole.name());
        EXPECT_EQ(range.offset(), 256U);
        EXPECT_EQ(range.bytes(), 260U);
        range.clear(7);
        const std::vector<std::uint32_t> words = {1, 2};
        range.upload(std::as_bytes(std::span(words)), 4);
        EXPECT_EQ(as<std::uint32_t>(range.download(0, 16)), (std::vector<std::uint32_t>{7, 1, 2, 7}));
        gl::Buffer copy(260, "copy");
        gl::copyResource(range, copy);
        EXPECT_EQ(copy.download(), range.download());
        gl::copyResource(copy, whole.range(512, 260));
        EXPECT_EQ(whole.range(512, 260).download(), copy.download());
        GLint texels = 0;
        glGetTextureLevelParameteriv(range.texelView(Format::R32UI), 0, GL_TEXTURE_WIDTH, &texels);
        EXPECT_EQ(texels, 65);
    }
    std::vector<std::uint32_t> expected(256, 0);
    for (size_t i = 0; i < 65; ++i) expected[64 + i] = expected[128 + i] = 7;
    expected[65] = expected[129] = 1;
    expected[66] = expected[130] = 2;
    EXPECT_EQ(as<std::uint32_t>(whole.download()), expected)
        << "outside nothing changes, and it outlives them";
}

TEST_F(ObjectsTest, RangesMayBeginAtEveryMultipleOf256) {
    for (const GLenum what : {GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT, GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT,
                              GL_TEXTURE_BUFFER_OFFSET_ALIGNMENT}) {
        GLint alignment = 0;
        glGetIntegerv(what, &alignment);
        ASSERT_GT(alignment, 0);
        EXPECT_EQ(rangeAlignment % static_cast<std::uint64_t>(alignment), 0U);
    }
}

TEST_F(ObjectsTest, TexturesAreCopiedWithAllTheirLevels) {
    Desc desc = Desc::texture3D(Format::R32UI, {4, 2, 2}, 2);
    gl::Texture from(desc, "from"), to(desc, "to");
    from.clear(glm::vec4(5));
    gl::copyResource(from, to);
    EXPECT_EQ(as<std::uint32_t>(to.download(-1, 0)), std::vector<std::uint32_t>(16, 5));
    EXPECT_EQ(as<std::uint32_t>(to.download(-1, 1)), std::vector<std::uint32_t>(2, 5));
}

TEST_F(ObjectsTest, WhatTheDeviceCannotHoldIsNamed) {
    EXPECT_THAT(messageOf<MachineError>([] { gl::Buffer(UINT64_MAX - 3, "endless"); }),
                HasSubstr("no memory for buffer 'endless' of 18446744073709551612 bytes"));
    EXPECT_THAT(messageOf<MachineError>([] { gl::Buffer(std::uint64_t{1} << 50, "petabyte"); }),
                HasSubstr("no memory for buffer 'petabyte' of 1125899906842624 bytes"));
    EXPECT_THAT(messageOf<MachineError>([] {
                    gl::Texture(Desc::texture2D(Format::R8, {1U << 20, 4, 1}), "wide");
                }),
                HasSubstr("texture 'wide' needs 1048576 texels in width, the device has at most"));
    EXPECT_THAT(messageOf<MachineError>([] {
                    gl::Texture(Desc::texture3D(Format::R8, {4, 4, 1U << 20}), "deep");
                }),
                HasSubstr("texture 'deep' needs 1048576 texels in depth"));
    EXPECT_THAT(messageOf<MachineError>([] {
                    gl::Texture(Desc::array2D(Format::R8, {4, 4, 1U << 20}), "many");
                }),
                HasSubstr("texture 'many' needs 1048576 layers"));
    const int side = test::context().capabilities().max3DTextureSize;
    const auto texels = static_cast<std::uint32_t>(side);
    EXPECT_THAT(messageOf<MachineError>([&] {
                    gl::Texture(Desc::texture3D(Format::RGBA32F, {texels, texels, texels}), "huge");
                }),
                HasSubstr("no memory for texture 'huge'"));
}

TEST_F(ObjectsTest, FramebuffersAreMadeOnceAndNotMistaken) {
    gl::FramebufferCache cache;
    gl::Texture colour(Desc::texture2D(Format::RGBA8, {4, 4, 1}), "colour");
    gl::Texture depth(Desc::texture2D(Format::D32F, {4, 4, 1}), "depth");
    const gl::Name both = cache.get({{&colour}}, {&depth}, {});
    EXPECT_EQ(cache.get({{&colour}}, {&depth}, {}), both);
    EXPECT_NE(cache.get({{&colour}}, {}, {}), both);
    EXPECT_NE(cache.get({}, {}, {8, 8, 1}), cache.get({}, {}, {16, 8, 1}));
    EXPECT_EQ(cache.size(), 4U);
    // A new texture may get the name of one that is gone; it is another one all the same.
    const gl::Name oldName = colour.name();
    colour = gl::Texture();
    gl::Texture other(Desc::texture2D(Format::RGBA8, {4, 4, 1}), "other");
    EXPECT_NE(cache.get({{&other}}, {&depth}, {}), both)
        << "old name " << oldName << ", new " << other.name();
    cache.clear();
    EXPECT_EQ(cache.size(), 0U);
}

TEST_F(ObjectsTest, EveryColourFormatCanBeDrawnToOrIsNamed) {
    for (const Format format : allFormats()) {
        if (formatInfo(format).depth) continue;
        gl::Texture texture(Desc::texture2D(format, {2, 2, 1}), "target");
        gl::FramebufferCache cache;
        EXPECT_NO_THROW(cache.get({{&texture}}, {}, {})) << formatInfo(format).name;
    }
    gl::Texture depth(Desc::texture2D(Format::D32F, {2, 2, 1}), "depth");
    gl::FramebufferCache cache;
    EXPECT_THAT(messageOf<MachineError>([&] { cache.get({{&depth}}, {}, {}); }), HasSubstr("cannot draw to"));
}

TEST_F(ObjectsTest, SamplersFilterAsTheyAreAsked) {
    const gl::Program program =
        test::computeProgram("layout(local_size_x = 1) in;\n"
                             "uniform sampler2D source;\n"
                             "layout(std430) writeonly buffer Result { float result[]; };\n"
                             "void main() {\n"
                             "    result[0] = textureLod(source, vec2(0.375, 0.5), 0.0).r;\n"
                             "    result[1] = textureLod(source, vec2(1.25, 0.5), 0.0).r;\n"
                             "}\n");
    gl::Texture texture(Desc::texture2D(Format::R32F, {2, 1, 1}), "two texels");
    const std::vector<float> texels = {0, 8};
    texture.upload(std::as_bytes(std::span(texels)));
    gl::SamplerCache samplers;
    const auto read = [&](const gl::SamplerState& state) {
        gl::Buffer result(8, "result");
        program.use();
        const unsigned int unit = program.slot("source")->unit;
        glBindTextureUnit(unit, texture.name());
        glBindSampler(unit, samplers.get(state));
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, program.slot("Result")->unit, result.name());
        glDispatchCompute(1, 1, 1);
        glBindSampler(unit, 0);
        return as<float>(result.download());
    };
    EXPECT_EQ(read({}), (std::vector<float>{0, 8}));
    EXPECT_EQ(read({.linear = true}), (std::vector<float>{2, 8}));
    EXPECT_EQ(read({.wrapping = gl::Wrapping::Repeat}), (std::vector<float>{0, 0}));
    EXPECT_EQ(read({.wrapping = gl::Wrapping::MirroredRepeat}), (std::vector<float>{0, 8}));
    EXPECT_EQ(samplers.get({.linear = true}), samplers.get({.linear = true}));
}

} // namespace
} // namespace kestrel
