// The blocks that C++ fills have the layout that the driver gives them in GLSL.
#include "draw/view_data.h"
#include "gl_fixture.h"
#include "shared/scene.h"
#include <cstddef>

namespace kestrel {
namespace {

using shared::LightRecord;
using shared::MaterialRecord;
using shared::TextureRecord;
using shared::VertexRecord;

class SharedLayout : public test::GlTest {};

// A block of a linked program, by its name: bytes of it, and of its members from its begin. `block` and
// `variable` are the program interfaces of its kind. Of an array of structs the driver names the first
// element.
class Block {
public:
    static Block uniform(const gl::Program& program, const char* name) {
        return {program, name, GL_UNIFORM_BLOCK, GL_UNIFORM};
    }
    static Block storage(const gl::Program& program, const char* name) {
        return {program, name, GL_SHADER_STORAGE_BLOCK, GL_BUFFER_VARIABLE};
    }

    [[nodiscard]] size_t size() const { return asked(block_, name_, GL_BUFFER_DATA_SIZE); }
    [[nodiscard]] size_t offset(const std::string& member) const {
        return asked(variable_, member.c_str(), GL_OFFSET);
    }
    // From struct to struct of the array that the member lies in.
    [[nodiscard]] size_t stride(const std::string& member) const {
        return asked(variable_, member.c_str(), GL_TOP_LEVEL_ARRAY_STRIDE);
    }

private:
    Block(const gl::Program& program, const char* name, GLenum block, GLenum variable)
        : program_(program.name())
        , name_(name)
        , block_(block)
        , variable_(variable) {}

    [[nodiscard]] size_t asked(GLenum interface, const char* name, GLenum property) const {
        const GLuint index = glGetProgramResourceIndex(program_, interface, name);
        EXPECT_NE(index, GL_INVALID_INDEX) << name;
        GLint value = -1;
        if (index != GL_INVALID_INDEX)
            glGetProgramResourceiv(program_, interface, index, 1, &property, 1, nullptr, &value);
        return static_cast<size_t>(value);
    }

    GLuint program_;
    const char* name_;
    GLenum block_, variable_;
};

void expectOffset(const Block& block, const std::string& member, size_t offset) {
    EXPECT_EQ(block.offset(member), offset) << member;
}

TEST_F(SharedLayout, Frame) {
    const gl::Program program =
        test::computeProgram("#include \"lib/frame.glsl\"\n"
                             "layout(local_size_x = 1) in;\n"
                             "layout(std430) buffer Out { vec4 result; };\n"
                             "void main() { result = frame.sceneBounds + frame.time; }\n");
    const Block block = Block::uniform(program, "Frame");
    EXPECT_EQ(block.size(), sizeof(FrameData));
    expectOffset(block, "frame.size", offsetof(FrameData, size));
    expectOffset(block, "frame.index", offsetof(FrameData, index));
    expectOffset(block, "frame.seed", offsetof(FrameData, seed));
    expectOffset(block, "frame.time", offsetof(FrameData, time));
    expectOffset(block, "frame.sceneBounds", offsetof(FrameData, sceneBounds));
}

TEST_F(SharedLayout, View) {
    const gl::Program program = test::computeProgram(
        "#include \"lib/view.glsl\"\n"
        "layout(local_size_x = 1) in;\n"
        "layout(std140) uniform DepthView { ViewData view; };\n"
        "layout(std430) buffer Out { vec4 result; };\n"
        "void main() { result = vec4(positionFromDepth(view, vec2(0), 0.5), view.farPlane); }\n");
    const Block block = Block::uniform(program, "DepthView");
    EXPECT_EQ(block.size(), sizeof(ViewData));
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
    for (const auto& [member, offset] : members) expectOffset(block, member, offset);
}

TEST_F(SharedLayout, SceneRecords) {
    const gl::Program program = test::computeProgram(
        "#include \"lib/material.glsl\"\n"
        "#include \"lib/lights.glsl\"\n"
        "layout(local_size_x = 1) in;\n"
        "layout(std430) buffer SceneVertices { VertexRecord vertices[]; };\n"
        "layout(std430) buffer Out { vec4 result; };\n"
        "void main() {\n"
        "    result = scene_materials[1].normalTexture.matrix + scene_lights[1].halfSize.x +\n"
        "             vertices[1].colour;\n"
        "}\n");
    const Block materials = Block::storage(program, "Materials");
    const Block lights = Block::storage(program, "Lights");
    const Block vertices = Block::storage(program, "SceneVertices");

    const std::string m = "scene_materials[0].";
    EXPECT_EQ(materials.stride(m + "baseColour"), sizeof(MaterialRecord));
    expectOffset(materials, m + "baseColour", offsetof(MaterialRecord, baseColour));
    expectOffset(materials, m + "emission", offsetof(MaterialRecord, emission));
    expectOffset(materials, m + "metallic", offsetof(MaterialRecord, metallic));
    expectOffset(materials, m + "roughness", offsetof(MaterialRecord, roughness));
    expectOffset(materials, m + "normalScale", offsetof(MaterialRecord, normalScale));
    expectOffset(materials, m + "alphaCutoff", offsetof(MaterialRecord, alphaCutoff));
    expectOffset(materials, m + "flags", offsetof(MaterialRecord, flags));
    expectOffset(materials, m + "transmission", offsetof(MaterialRecord, transmission));
    expectOffset(materials, m + "ior", offsetof(MaterialRecord, ior));
    const std::pair<const char*, size_t> textures[] = {
        {"baseColourTexture", offsetof(MaterialRecord, baseColourTexture)},
        {"metallicRoughnessTexture", offsetof(MaterialRecord, metallicRoughnessTexture)},
        {"normalTexture", offsetof(MaterialRecord, normalTexture)},
        {"emissionTexture", offsetof(MaterialRecord, emissionTexture)}};
    for (const auto& [name, base] : textures) {
        const std::string t = m + name + ".";
        expectOffset(materials, t + "matrix", base + offsetof(TextureRecord, matrix));
        expectOffset(materials, t + "offset", base + offsetof(TextureRecord, offset));
        expectOffset(materials, t + "place", base + offsetof(TextureRecord, place));
        expectOffset(materials, t + "flags", base + offsetof(TextureRecord, flags));
        expectOffset(materials, t + "source", base + offsetof(TextureRecord, source));
        expectOffset(materials, t + "side", base + offsetof(TextureRecord, side));
    }

    const std::string l = "scene_lights[0].";
    expectOffset(lights, "scene_light_count", 0);
    constexpr size_t records = 16; // where GpuScene puts the first record
    EXPECT_EQ(lights.stride(l + "position"), sizeof(LightRecord));
    expectOffset(lights, l + "position", records + offsetof(LightRecord, position));
    expectOffset(lights, l + "kind", records + offsetof(LightRecord, kind));
    expectOffset(lights, l + "direction", records + offsetof(LightRecord, direction));
    expectOffset(lights, l + "range", records + offsetof(LightRecord, range));
    expectOffset(lights, l + "intensity", records + offsetof(LightRecord, intensity));
    expectOffset(lights, l + "cosInnerCone", records + offsetof(LightRecord, cosInnerCone));
    expectOffset(lights, l + "tangent", records + offsetof(LightRecord, tangent));
    expectOffset(lights, l + "cosOuterCone", records + offsetof(LightRecord, cosOuterCone));
    expectOffset(lights, l + "bitangent", records + offsetof(LightRecord, bitangent));
    expectOffset(lights, l + "halfSize", records + offsetof(LightRecord, halfSize));

    const std::string v = "vertices[0].";
    EXPECT_EQ(vertices.stride(v + "normal"), sizeof(VertexRecord));
    expectOffset(vertices, v + "tangent", offsetof(VertexRecord, tangent));
    expectOffset(vertices, v + "texCoord", offsetof(VertexRecord, texCoord));
    expectOffset(vertices, v + "texCoord1", offsetof(VertexRecord, texCoord1));
    expectOffset(vertices, v + "colour", offsetof(VertexRecord, colour));
}

} // namespace
} // namespace kestrel
