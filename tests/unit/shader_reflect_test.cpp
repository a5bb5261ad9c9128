#include "core/error.h"
#include "shader/reflect.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> namesOf(const Reflection& reflection) {
    std::vector<std::string> names;
    for (const ShaderResource& resource : reflection.resources) names.push_back(resource.name);
    return names;
}

// A compute shader's reflection: declarations, and statements that use them.
Reflection reflectCompute(const std::string& declarations, const std::string& statements) {
    ShaderLibrary library;
    library.addVirtual("x.comp", "layout(local_size_x = 8, local_size_y = 4) in;\n" + declarations +
                                     "buffer Out { float result; };\nvoid main() { " + statements + " }\n");
    return reflect(compose({{"x.comp"}, {}, {}}, library));
}

std::vector<BlockMember> membersOf(const Reflection& reflection, std::string_view name) {
    const ShaderResource* block = reflection.find(name);
    return block ? block->members : std::vector<BlockMember>{};
}

constexpr const char* members =
    "{ float a; vec3 b; float c; vec3 d[2]; mat4 e; float f[3]; uvec2 g; mat3x2 h; };\n";

TEST(Reflect, TellsTheLayoutOfAStd140BlockWhereOnlyOneMemberIsRead) {
    const Reflection reflection =
        reflectCompute(std::string("layout(std140) uniform Block ") + members, "result = c;");
    const ShaderResource* block = reflection.find("Block");
    ASSERT_NE(block, nullptr);
    EXPECT_EQ(block->kind, ShaderResource::UniformBlock);
    EXPECT_EQ(block->size, 240u);
    EXPECT_THAT(block->members,
                ElementsAre(BlockMember{"a", "float", 0, 0, 0, 0}, BlockMember{"b", "vec3", 16, 0, 0, 0},
                            BlockMember{"c", "float", 28, 0, 0, 0}, BlockMember{"d", "vec3", 32, 2, 16, 0},
                            BlockMember{"e", "mat4", 64, 0, 0, 0}, BlockMember{"f", "float", 128, 3, 16, 0},
                            BlockMember{"g", "uvec2", 176, 0, 0, 0},
                            BlockMember{"h", "mat3x2", 192, 0, 0, 0}));
    EXPECT_EQ(reflection.localSize, (std::array<int, 3>{8, 4, 1}));
}

TEST(Reflect, TellsTheLayoutOfAStd430Block) {
    const Reflection reflection =
        reflectCompute(std::string("layout(std430) buffer Block ") + members, "result = c;");
    const ShaderResource* block = reflection.find("Block");
    ASSERT_NE(block, nullptr);
    EXPECT_EQ(block->kind, ShaderResource::StorageBlock);
    EXPECT_THAT(block->members,
                ElementsAre(BlockMember{"a", "float", 0, 0, 0, 0}, BlockMember{"b", "vec3", 16, 0, 0, 0},
                            BlockMember{"c", "float", 28, 0, 0, 0}, BlockMember{"d", "vec3", 32, 2, 16, 0},
                            BlockMember{"e", "mat4", 64, 0, 0, 0}, BlockMember{"f", "float", 128, 3, 4, 0},
                            BlockMember{"g", "uvec2", 144, 0, 0, 0},
                            BlockMember{"h", "mat3x2", 152, 0, 0, 0}));
    EXPECT_EQ(block->size, 176u);
}

TEST(Reflect, FollowsStructsAndUnsizedArrays) {
    const Reflection reflection = reflectCompute(
        "struct Light { vec3 colour; float reach; };\n"
        "layout(std140) uniform Lights { Light sun; Light lights[4]; uint count; } theLights;\n"
        "layout(std430) buffer Nodes { uint count; Light nodes[]; };\n"
        "layout(std430) buffer Words { uint words[]; } theWords;\n",
        "result = theLights.lights[1].reach + nodes[3].reach + float(theWords.words[1]);");
    EXPECT_THAT(membersOf(reflection, "Lights"),
                ElementsAre(BlockMember{"sun.colour", "vec3", 0, 0, 0, 0},
                            BlockMember{"sun.reach", "float", 12, 0, 0, 0},
                            BlockMember{"lights[0].colour", "vec3", 16, 0, 0, 16},
                            BlockMember{"lights[0].reach", "float", 28, 0, 0, 16},
                            BlockMember{"count", "uint", 80, 0, 0, 0}));
    EXPECT_THAT(membersOf(reflection, "Nodes"),
                ElementsAre(BlockMember{"count", "uint", 0, 0, 0, 0},
                            BlockMember{"nodes[0].colour", "vec3", 16, 0, 0, 16},
                            BlockMember{"nodes[0].reach", "float", 28, 0, 0, 16}));
    EXPECT_THAT(membersOf(reflection, "Words"), ElementsAre(BlockMember{"words", "uint", 0, -1, 4, 0}));
}

TEST(Reflect, ListsLooseUniformsSamplersAndImagesThatAreUsed) {
    const Reflection reflection = reflectCompute(
        "uniform float gain;\nuniform vec4 planes[6];\nuniform float unused;\nuniform sampler2D depth;\n"
        "uniform usampler3D cells;\nuniform sampler2D shadows[2];\n"
        "layout(r32ui) uniform uimage2DArray counts;\n",
        "result = gain + planes[2].x + texelFetch(depth, ivec2(0), 0).x + float(texelFetch(cells, ivec3(0), "
        "0).x) + "
        "textureLod(shadows[1], vec2(0), 0).x; imageAtomicOr(counts, ivec3(0), 1u);");
    EXPECT_THAT(namesOf(reflection),
                ElementsAre("Out", "cells", "counts", "depth", "gain", "planes", "shadows"));
    EXPECT_EQ(reflection.find("gain")->kind, ShaderResource::Uniform);
    EXPECT_EQ(reflection.find("gain")->type, "float");
    EXPECT_EQ(reflection.find("planes")->type, "vec4");
    EXPECT_EQ(reflection.find("planes")->arraySize, 6);
    EXPECT_EQ(reflection.find("depth")->kind, ShaderResource::Sampler);
    EXPECT_EQ(reflection.find("depth")->type, "sampler2D");
    EXPECT_EQ(reflection.find("cells")->type, "usampler3D");
    EXPECT_EQ(reflection.find("shadows")->arraySize, 2);
    EXPECT_EQ(reflection.find("counts")->kind, ShaderResource::Image);
    EXPECT_EQ(reflection.find("counts")->type, "uimage2DArray");
    EXPECT_EQ(reflection.find("counts")->format, "r32ui");
    EXPECT_EQ(reflection.find("unused"), nullptr);
}

TEST(Reflect, TellsTheStagesOfAResource) {
    ShaderLibrary library;
    library.addVirtual(
        "x.vert", "layout(std140) uniform Camera { mat4 view; };\nvoid main() { gl_Position = view[0]; }\n");
    library.addVirtual(
        "x.frag", "layout(std140) uniform Camera { mat4 view; };\nuniform float gain;\nout vec4 colour;\n"
                  "void main() { colour = view[1] * gain; }\n");
    const Reflection reflection = reflect(compose({{"x.vert", "x.frag"}, {}, {}}, library));
    EXPECT_THAT(namesOf(reflection), ElementsAre("Camera", "gain"));
    EXPECT_THAT(reflection.find("Camera")->stages, ElementsAre(ShaderStage::Vertex, ShaderStage::Fragment));
    EXPECT_THAT(reflection.find("gain")->stages, ElementsAre(ShaderStage::Fragment));
    EXPECT_EQ(reflection.localSize, (std::array<int, 3>{0, 0, 0}));
}

TEST(Reflect, NamesTheBlocksOfModulesByTheirPath) {
    ShaderLibrary library;
    library.addVirtual("m.glsl", "layout(std140) uniform M(Block) { float reach; } M(own);\n"
                                 "float M(reach)() { return M(own).reach; }\n");
    library.addVirtual("x.comp",
                       "#include <port:a>\n#include <port:b>\nlayout(local_size_x = 1) in;\n"
                       "buffer Out { float result; };\nvoid main() { result = a_reach() + b_reach(); }\n");
    const ModuleInstance module{"m.glsl", {}, {}};
    const Reflection reflection = reflect(compose({{"x.comp"}, {}, {{"a", module}, {"b", module}}}, library));
    EXPECT_THAT(namesOf(reflection), ElementsAre("Out", "a_Block", "b_Block"));
    EXPECT_NE(reflection.find("a_Block")->member("reach"), nullptr);
}

TEST(Reflect, RefusesProgramsThatDoNotCompileOrThatOnlyTheDriverKnows) {
    ShaderLibrary library;
    library.addVirtual("x.comp", "layout(local_size_x = 1) in;\nvoid main() { x = 1; }\n");
    try {
        reflect(compose({{"x.comp"}, {}, {}}, library));
        FAIL() << "no error";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("x.comp:2: 'x' : undeclared identifier"));
    }
    library.addVirtual("y.comp", "#extension GL_NV_shader_atomic_float : require\nvoid main() {}\n");
    try {
        reflect(compose({{"y.comp"}, {}, {}}, library));
        FAIL() << "no error";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("y.comp: uses an extension that glslang does not know"));
    }
}

} // namespace
} // namespace kestrel
