#include "core/error.h"
#include "gl_fixture.h"
#include "support/temporary_folder.h"
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>

namespace kestrel {
namespace {

using test::composeTexts;
using test::computeProgram;
using test::messageOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Kind = gl::Program::Slot::Kind;

class ProgramTest : public test::GlTest {};

const char* const manyResources =
    "layout(local_size_x = 4, local_size_y = 2) in;\n"
    "uniform sampler2D depth;\n"
    "uniform sampler2DArray colours[3];\n"
    "uniform usamplerBuffer counts;\n"
    "layout(r32f) uniform image2D result;\n"
    "layout(r32ui) uniform readonly uimageBuffer nodes;\n"
    "layout(r32ui) uniform uimage3D map;\n"
    "layout(std140) uniform DepthView { vec4 view; };\n"
    "layout(std430) buffer Rays { float rays[]; };\n"
    "layout(std430) buffer Hits { float hits[]; };\n"
    "uniform float reach;\n"
    "uniform vec4 weights[5];\n"
    "uniform sampler2D unused;\n"
    "void main() {\n"
    "    float sum = texelFetch(depth, ivec2(0), 0).r + reach + weights[3].x + view.x;\n"
    "    for (int i = 0; i < 3; ++i) sum += texelFetch(colours[i], ivec3(0), 0).r;\n"
    "    sum += float(texelFetch(counts, 0).r + imageLoad(nodes, 1).r);\n"
    "    imageAtomicOr(map, ivec3(0), 1u);\n"
    "    imageStore(result, ivec2(0), vec4(sum));\n"
    "    hits[0] = rays[0];\n"
    "}\n";

TEST_F(ProgramTest, GivesEveryResourceAUnitOfItsOwn) {
    const gl::Program program = computeProgram(manyResources);
    EXPECT_EQ(program.localSize(), glm::uvec3(4, 2, 1));
    EXPECT_THAT(program.slotNames(), ElementsAre("DepthView", "Hits", "Rays", "colours", "counts", "depth",
                                                 "map", "nodes", "result"));
    std::set<unsigned int> textureUnits;
    for (const char* name : {"depth", "colours", "counts"}) {
        const auto slot = program.slot(name).value();
        EXPECT_EQ(slot.kind, Kind::Sampler);
        for (int i = 0; i < slot.count; ++i) textureUnits.insert(slot.unit + static_cast<unsigned int>(i));
    }
    EXPECT_EQ(textureUnits.size(), 5U);
    EXPECT_EQ(program.slot("colours")->count, 3);
    EXPECT_TRUE(program.slot("colours")->array3D);
    EXPECT_TRUE(program.slot("counts")->texels);
    EXPECT_TRUE(program.slot("map")->array3D);
    EXPECT_FALSE(program.slot("result")->array3D);
    EXPECT_EQ(program.slot("nodes")->kind, Kind::Image);
    EXPECT_NE(program.slot("Rays")->unit, program.slot("Hits")->unit);
    EXPECT_EQ(program.slot("DepthView")->kind, Kind::UniformBlock);
    EXPECT_FALSE(program.slot("unused").has_value());
    EXPECT_GE(program.uniform("reach"), 0);
    EXPECT_GE(program.uniform("weights"), 0);
    EXPECT_EQ(program.uniform("weights"), program.uniform("weights[0]"));
    EXPECT_EQ(program.uniform("missing"), -1);
}

TEST_F(ProgramTest, TellsAnUnusedNameFromAMisspeltOne) {
    const gl::Program program = computeProgram("layout(local_size_x = 1) in;\n"
                                               "uniform float unused; // never: commented\n"
                                               "void main() {}\n");
    EXPECT_TRUE(program.mentions("unused"));
    EXPECT_FALSE(program.mentions("commented"));
    EXPECT_FALSE(program.mentions("unuse"));
}

TEST_F(ProgramTest, BindsWhatTheSlotsSay) {
    const gl::Program program = computeProgram("layout(local_size_x = 1) in;\n"
                                               "layout(std430) readonly buffer Second { uint b[]; };\n"
                                               "layout(std430) readonly buffer First { uint a[]; };\n"
                                               "layout(r32ui) uniform readonly uimageBuffer texels;\n"
                                               "uniform usamplerBuffer fetched;\n"
                                               "layout(std430) writeonly buffer Result { uint c[]; };\n"
                                               "void main() { c[0] = a[0] + b[0] + imageLoad(texels, 1).r +\n"
                                               "              texelFetch(fetched, 2).r; }\n");
    const std::vector<std::uint32_t> values = {1, 20, 300};
    gl::Buffer first(4, "first"), second(4, "second"), texels(12, "texels"), result(4, "result");
    first.clear(1000);
    second.clear(20000);
    texels.upload(std::as_bytes(std::span(values)));
    program.use();
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, program.slot("First")->unit, first.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, program.slot("Second")->unit, second.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, program.slot("Result")->unit, result.name());
    glBindImageTexture(program.slot("texels")->unit, texels.texelView(Format::R32UI), 0, GL_FALSE, 0,
                       GL_READ_ONLY, GL_R32UI);
    glBindTextureUnit(program.slot("fetched")->unit, texels.texelView(Format::R32UI));
    glDispatchCompute(1, 1, 1);
    EXPECT_EQ(test::as<std::uint32_t>(result.download())[0], 21320U);
}

TEST_F(ProgramTest, ABarrierShowsADispatchWhatADrawHasWritten) {
    // The one case in which a CPU driver, too, shows a missing barrier: draws are deferred, dispatches are
    // not.
    const std::string fragment = "layout(std430) buffer Values { uint values[]; };\n"
                                 "void main() { values[int(gl_FragCoord.x)] = 7u; }\n";
    const gl::Program draw(composeTexts({{"t.vert", test::fullscreenVertex()}, {"t.frag", fragment}}), {},
                           test::context().capabilities());
    const gl::Program read =
        computeProgram("layout(local_size_x = 64) in;\n"
                       "layout(std430) readonly buffer Values { uint values[]; };\n"
                       "layout(std430) writeonly buffer Copies { uint copies[]; };\n"
                       "void main() { uint i = gl_GlobalInvocationID.x; copies[i] = values[i]; }\n");
    constexpr int count = 256;
    gl::Buffer values(4 * count, "values"), copies(4 * count, "copies");
    gl::VertexArray none("none");
    gl::FramebufferCache framebuffers;
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers.get({}, {}, {count, 1, 1}));
    glViewport(0, 0, count, 1);
    glDisable(GL_DEPTH_TEST);
    draw.use();
    glBindVertexArray(none.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, draw.slot("Values")->unit, values.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    read.use();
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, read.slot("Values")->unit, values.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, read.slot("Copies")->unit, copies.name());
    glDispatchCompute(count / 64, 1, 1);
    EXPECT_EQ(test::as<std::uint32_t>(copies.download()), std::vector<std::uint32_t>(count, 7));
}

TEST_F(ProgramTest, PutsOutputsAtTheirAttachments) {
    const std::string fragment = "out vec4 out_albedo;\nout vec4 out_normal;\n"
                                 "void main() { out_albedo = vec4(0.25); out_normal = vec4(0.75); }\n";
    const auto composed = composeTexts({{"t.vert", test::fullscreenVertex()}, {"t.frag", fragment}});
    const gl::Program program(composed, {"normal", "albedo"}, test::context().capabilities());
    gl::Texture normal(Desc::texture2D(Format::R32F, {4, 4, 1}), "normal");
    gl::Texture albedo(Desc::texture2D(Format::R32F, {4, 4, 1}), "albedo");
    gl::FramebufferCache framebuffers;
    gl::VertexArray none("none");
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers.get({{&normal}, {&albedo}}, {}, {}));
    glViewport(0, 0, 4, 4);
    program.use();
    glBindVertexArray(none.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    EXPECT_EQ(test::as<float>(normal.download()), std::vector<float>(16, 0.75F));
    EXPECT_EQ(test::as<float>(albedo.download()), std::vector<float>(16, 0.25F));

    const std::string message = messageOf<InputError>([&] {
        gl::Program(composed, {"normal", "albdo"}, test::context().capabilities());
    });
    EXPECT_THAT(message,
                HasSubstr("t.frag: output 'out_albedo' has no attachment 'albedo' (did you mean 'albdo'?)"));
}

TEST_F(ProgramTest, CompileErrorsNameFileLineAndSource) {
    ShaderLibrary library;
    library.addVirtual("lib/half.glsl", "float half_of(float x) {\n    return x * 0.5\n}\n");
    library.addVirtual("a.comp",
                       "#include \"lib/half.glsl\"\nlayout(local_size_x = 1) in;\nvoid main() {}\n");
    const ComposedProgram composed = compose({{"a.comp"}, {}, {}}, library);
    const std::string inLibrary =
        messageOf<InputError>([&] { gl::Program(composed, {}, test::context().capabilities()); });
    EXPECT_THAT(inLibrary, HasSubstr("lib/half.glsl:3"));
    const std::string inStage = messageOf<InputError>([] {
        computeProgram("layout(local_size_x = 1) in;\n"
                       "void main() {\n"
                       "    float x = undeclared;\n"
                       "}\n");
    });
    EXPECT_THAT(inStage, HasSubstr("test.comp:3"));
    EXPECT_THAT(inStage, HasSubstr("float x = undeclared;"));
}

TEST_F(ProgramTest, ErrorsOfAllStagesComeTogether) {
    const std::string message = messageOf<InputError>([] {
        gl::Program(composeTexts({{"t.vert", "void main() { gl_Position = first; }\n"},
                                  {"t.frag", "out vec4 out_x;\nvoid main() { out_x = second; }\n"}}),
                    {"x"}, test::context().capabilities());
    });
    EXPECT_THAT(message, HasSubstr("t.vert:1"));
    EXPECT_THAT(message, HasSubstr("t.frag:2"));
}

TEST_F(ProgramTest, LinkErrorsNameTheProgram) {
    const std::string message = messageOf<InputError>([] {
        gl::Program(
            composeTexts(
                {{"t.vert", "out vec3 colour;\nvoid main() { colour = vec3(1); gl_Position = vec4(0); }\n"},
                 {"t.frag", "in vec2 colour;\nout vec4 out_x;\nvoid main() { out_x = colour.xyxy; }\n"}}),
            {"x"}, test::context().capabilities());
    });
    EXPECT_THAT(message, HasSubstr("t.vert+t.frag"));
    EXPECT_THAT(message, HasSubstr("colour"));
}

TEST_F(ProgramTest, MoreResourcesThanTheDeviceHasNamesNeedAndLimit) {
    Capabilities few = test::context().capabilities();
    few.maxTextureUnits = 4;
    few.maxComputeImages = 2;
    few.maxStorageBlocks = 1;
    few.maxUniformBlocks = 0;
    const ComposedProgram composed = composeTexts({{"test.comp", manyResources}});
    const std::string message = messageOf<InputError>([&] { gl::Program(composed, {}, few); });
    EXPECT_THAT(message, HasSubstr("test.comp: a stage uses 5 samplers, the device has 4 a stage"));
    EXPECT_THAT(message, HasSubstr("a stage uses 3 images, the device has 2 a stage"));
    EXPECT_THAT(message, HasSubstr("a stage uses 2 storage blocks, the device has 1 a stage"));
    EXPECT_THAT(message, HasSubstr("a stage uses 1 uniform blocks, the device has 0 a stage"));
}

// ---- the binary cache

class ProgramCacheTest : public test::GlTest {
protected:
    void SetUp() override {
        GlTest::SetUp();
        GLint formats = 0;
        glGetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &formats);
        if (formats == 0) GTEST_SKIP() << "the driver has no program binary format";
        gl::setProgramCache(folder_.string());
    }
    void TearDown() override {
        gl::setProgramCache("");
        GlTest::TearDown();
    }
    [[nodiscard]] std::vector<std::filesystem::path> files() const {
        std::vector<std::filesystem::path> result;
        for (const auto& entry : std::filesystem::directory_iterator(folder_)) result.push_back(entry.path());
        return result;
    }
    static gl::Program make(int value) {
        return computeProgram("layout(local_size_x = 3) in;\n"
                              "uniform uint added;\n"
                              "layout(std430) writeonly buffer Result { uint result[]; };\n"
                              "void main() { result[0] = uint(VALUE) + added; }\n",
                              {{"VALUE", std::to_string(value)}});
    }
    static std::uint32_t run(const gl::Program& program) {
        gl::Buffer result(4, "result");
        program.use();
        glProgramUniform1ui(program.name(), program.uniform("added"), 30);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, program.slot("Result")->unit, result.name());
        glDispatchCompute(1, 1, 1);
        return test::as<std::uint32_t>(result.download())[0];
    }
    test::TemporaryFolder own_;
    const std::filesystem::path folder_ = own_ / "programs";
};

TEST_F(ProgramCacheTest, TheSecondTimeTheBinaryIsUsed) {
    EXPECT_FALSE(make(1).fromCache());
    EXPECT_EQ(files().size(), 1U);
    const gl::Program again = make(1);
    EXPECT_TRUE(again.fromCache());
    EXPECT_EQ(again.localSize(), glm::uvec3(3, 1, 1));
    EXPECT_EQ(run(again), 31U);
    EXPECT_FALSE(make(2).fromCache());
    EXPECT_EQ(files().size(), 2U);
}

TEST_F(ProgramCacheTest, DamagedFilesAreIgnoredAndWrittenAnew) {
    EXPECT_EQ(run(make(1)), 31U);
    const std::filesystem::path file = files().at(0);
    const auto size = std::filesystem::file_size(file);
    const auto damages = {
        +[](const std::filesystem::path& path, std::uintmax_t) { std::filesystem::resize_file(path, 0); },
        +[](const std::filesystem::path& path, std::uintmax_t) { std::filesystem::resize_file(path, 20); },
        +[](const std::filesystem::path& path, std::uintmax_t whole) {
            std::filesystem::resize_file(path, whole - 1);
        },
        +[](const std::filesystem::path& path, std::uintmax_t whole) {
            std::fstream stream(path, std::ios::in | std::ios::out | std::ios::binary);
            stream.seekp(static_cast<std::streamoff>(whole / 2));
            stream.put('\x5a').put('\x5a').put('\x5a').put('\x5a');
        },
        +[](const std::filesystem::path& path, std::uintmax_t) {
            std::fstream stream(path, std::ios::in | std::ios::out | std::ios::binary);
            stream.put('X'); // the magic number
        },
        +[](const std::filesystem::path& path, std::uintmax_t) {
            std::fstream stream(path, std::ios::in | std::ios::out | std::ios::binary);
            stream.seekp(40); // the driver's format: all is whole, and the driver refuses it
            stream.put('\x34').put('\x12');
        }};
    for (const auto damage : damages) {
        damage(file, size);
        const gl::Program program = make(1);
        EXPECT_FALSE(program.fromCache());
        EXPECT_EQ(run(program), 31U);
        EXPECT_EQ(std::filesystem::file_size(file), size);
        EXPECT_TRUE(make(1).fromCache());
    }
}

TEST_F(ProgramCacheTest, ABinaryOfAnotherProgramIsNotTaken) {
    EXPECT_EQ(run(make(1)), 31U);
    const std::filesystem::path first = files().at(0);
    EXPECT_EQ(run(make(2)), 32U);
    for (const auto& file : files())
        if (file != first)
            std::filesystem::copy_file(file, first, std::filesystem::copy_options::overwrite_existing);
    EXPECT_EQ(run(make(1)), 31U);
}

TEST_F(ProgramCacheTest, AFolderThatCannotBeWrittenStopsNothing) {
    std::ofstream(folder_.string() + "_file") << "no folder";
    gl::setProgramCache(folder_.string() + "_file");
    EXPECT_EQ(run(make(1)), 31U);
}

} // namespace
} // namespace kestrel
