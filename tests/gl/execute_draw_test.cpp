// Draws layer by layer, into one layer, with MIN and MAX blending, and as many vertices as a buffer says.
#include "execute_fixture.h"
#include <gmock/gmock.h>

namespace kestrel::test {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;

struct DrawTest : ExecuteTest {
    void SetUp() override {
        ExecuteTest::SetUp();
        shader("value.frag",
               "uniform float value;\nout float out_result;\nvoid main() { out_result = value; }\n");
        shader("plain.vert", R"(#include "lib/vertex.glsl"
            void main() { gl_Position = vec4(in_position.xy, 0.5, 1.0); })");
    }
    static Desc layered(ResourceKind kind, std::uint32_t depth) {
        Desc desc = Desc::array2D(Format::R32F, {4, 4, depth});
        desc.kind = kind;
        return desc;
    }
    // A pass with one step.
    void addPass(const std::string& type, const Output& result, const Step& step,
                 const std::function<void(Commands&)>& execute) {
        addType(
            type, {"out result"},
            [result, step](const FunctionPass&, const World&, const Inputs&) {
                Declaration declaration;
                declaration.outputs = {result};
                declaration.steps = {step};
                return declaration;
            },
            [execute](FunctionPass&, const Step&, Commands& commands) { execute(commands); });
    }
    std::unique_ptr<Renderer> run(const std::string& type) {
        auto made = rendererOf(graphOf({"p: " + type}, {}, {"p.result"}));
        made->frame();
        return made;
    }
};

const std::vector<TriangleClass> all = {TriangleClass::Opaque, TriangleClass::OpaqueDoubleSided};

TEST_F(DrawTest, TheSceneIsDrawnIntoLayerAfterLayer) {
    for (const ResourceKind kind : {ResourceKind::Texture2DArray, ResourceKind::TextureCube}) {
        const bool cube = kind == ResourceKind::TextureCube;
        const int layers = cube ? 6 : 3;
        const std::string type = cube ? "Cube" : "Array";
        addPass(type, {.port = "result", .desc = layered(kind, cube ? 1 : 3), .clear = glm::vec4(0)},
                stepOf("draw", {"plain.vert", "value.frag"}, {write("result", Access::Attachment)}),
                [layers](Commands& commands) {
                    commands.drawSceneLayers(
                        DrawState::overwrite(), all, static_cast<std::uint32_t>(layers),
                        [&](std::uint32_t layer) { commands.set("value", static_cast<float>(layer + 1)); });
                });
        const auto made = run(type);
        for (int layer = 0; layer < layers; ++layer)
            EXPECT_THAT(made->read({"p", "result"}, layer).values, Each(static_cast<float>(layer + 1)))
                << type << " " << layer;
    }
    addPass("TooMany", {.port = "result", .desc = layered(ResourceKind::Texture2DArray, 3)},
            stepOf("draw", {"plain.vert", "value.frag"}, {write("result", Access::Attachment)}),
            [](Commands& commands) { commands.drawSceneLayers({}, all, 4, [](std::uint32_t) {}); });
    EXPECT_THAT(messageOf<Error>([&] { run("TooMany"); }),
                HasSubstr("a draw of 4 layers into r32f 4x4, 3 layers"));
}

TEST_F(DrawTest, AUseMayNameOneLayer) {
    shader("one.comp", R"(layout(local_size_x = 4, local_size_y = 4) in;
        layout(r32f) uniform writeonly image2D result;
        void main() { imageStore(result, ivec2(gl_GlobalInvocationID.xy), vec4(7.0)); })");
    const Output array{
        .port = "result", .desc = layered(ResourceKind::Texture2DArray, 3), .clear = glm::vec4(0.5f)};
    addPass("Attachment", array,
            stepOf("draw", {"lib/fullscreen.vert", "value.frag"},
                   {{.port = "result", .access = Access::Attachment, .write = true, .layer = 1}}),
            [](Commands& commands) {
                commands.set("value", 7.0f);
                commands.drawFullscreen();
            });
    addPass("Image", array,
            stepOf("store", {"one.comp"},
                   {{.port = "result", .access = Access::Image, .write = true, .layer = 1}}),
            [](Commands& commands) { commands.dispatch(1); });
    for (const char* type : {"Attachment", "Image"}) {
        const auto made = run(type);
        EXPECT_THAT(made->read({"p", "result"}, 0).values, Each(0.5f)) << type;
        EXPECT_THAT(made->read({"p", "result"}, 1).values, Each(7.0f)) << type;
        EXPECT_THAT(made->read({"p", "result"}, 2).values, Each(0.5f)) << type;
    }
    Output cube = array;
    cube.desc = layered(ResourceKind::TextureCube, 1);
    addPass("Face", cube,
            stepOf("draw", {"lib/fullscreen.vert", "value.frag"},
                   {{.port = "result", .access = Access::Attachment, .write = true, .layer = 4}}),
            [](Commands& commands) {
                commands.set("value", 7.0f);
                commands.drawFullscreen();
            });
    const auto made = run("Face");
    for (int face = 0; face < 6; ++face)
        EXPECT_THAT(made->read({"p", "result"}, face).values, Each(face == 4 ? 7.0f : 0.5f)) << face;
}

TEST_F(DrawTest, TheSmallerOrTheLargerStays) {
    for (const bool larger : {false, true}) {
        const std::string type = larger ? "Max" : "Min";
        addPass(
            type,
            {.port = "result", .desc = Desc::texture2D(Format::R32F, {4, 4, 1}), .clear = glm::vec4(0.5f)},
            stepOf("draw", {"lib/fullscreen.vert", "value.frag"}, {write("result", Access::Attachment)}),
            [larger](Commands& commands) {
                DrawState state = DrawState::overwrite();
                state.blend = larger ? Blend::Max : Blend::Min;
                for (const float value : {0.25f, 0.75f, 0.4f}) {
                    commands.set("value", value);
                    commands.drawFullscreen(state);
                }
            });
        EXPECT_THAT(run(type)->read({"p", "result"}).values, Each(larger ? 0.75f : 0.25f));
    }
    // The equation of one draw does not stay for the next.
    addPass("Sum",
            {.port = "result", .desc = Desc::texture2D(Format::R32F, {4, 4, 1}), .clear = glm::vec4(0.5f)},
            stepOf("draw", {"lib/fullscreen.vert", "value.frag"}, {write("result", Access::Attachment)}),
            [](Commands& commands) {
                DrawState state = DrawState::overwrite();
                commands.set("value", 0.25f);
                state.blend = Blend::Max;
                commands.drawFullscreen(state);
                state.blend = Blend::Add;
                commands.drawFullscreen(state);
            });
    EXPECT_THAT(run("Sum")->read({"p", "result"}).values, Each(0.75f));
}

TEST_F(DrawTest, ABufferSaysHowManyVerticesAreDrawn) {
    shader("say.comp", R"(layout(local_size_x = 1) in;
        layout(std430) writeonly buffer Counts { uint counts[]; };
        uniform float value;
        void main() {
            counts[4] = 3u;
            counts[5] = uint(value);
            counts[6] = 0u;
            counts[7] = 0u;
        })");
    const auto add = [&](const std::string& type, std::uint64_t offset) {
        addType(
            type, {"buffer own counts", "out result"},
            [](const FunctionPass&, const World&, const Inputs&) {
                Declaration declaration;
                declaration.outputs = {{.port = "counts", .desc = Desc::buffer(32)},
                                       {.port = "result",
                                        .desc = Desc::texture2D(Format::R32F, {4, 4, 1}),
                                        .clear = glm::vec4(0)}};
                declaration.steps = {
                    stepOf("say", {"say.comp"}, {write("counts", Access::Storage)}),
                    stepOf("draw", {"lib/fullscreen.vert", "value.frag"},
                           {read("counts", Access::Indirect), write("result", Access::Attachment)})};
                declaration.depends = Causes::Properties;
                return declaration;
            },
            [offset](FunctionPass& pass, const Step& step, Commands& commands) {
                commands.set("value", step.name == "say" ? pass.value : 1.0f);
                if (step.name == "say") return commands.dispatch(1);
                DrawState state = DrawState::overwrite();
                state.blend = Blend::Add;
                commands.drawVerticesIndirect(state, "counts", offset);
            });
    };
    add("Count", 16);
    add("Beyond", 20);
    const auto made = rendererOf(graphOf({"p: Count = 2"}, {}, {"p.result"}));
    made->frame();
    EXPECT_THAT(made->read({"p", "result"}).values, Each(2.0f)) << "two instances, added";
    made->set("p.value=0");
    made->frame();
    EXPECT_THAT(made->read({"p", "result"}).values, Each(0.0f));
    EXPECT_THAT(messageOf<Error>([&] { run("Beyond"); }),
                HasSubstr("an indirect draw at byte 20 of 'counts', which has 32"));
}

} // namespace
} // namespace kestrel::test
