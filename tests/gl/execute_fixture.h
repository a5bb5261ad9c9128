// What the executor's tests share: passes made of two functions, shaders from text, graphs and a scene of one
// quad.
#pragma once
#include "core/files.h"
#include "execute/renderer.h"
#include "gl_fixture.h"
#include "graph/graph.h"
#include "support/temporary_folder.h"
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <map>

namespace kestrel::test {

// A pass whose two functions are given; it has one number, one text and counts its runs.
struct FunctionPass final : Pass {
    using Declare = std::function<Declaration(const FunctionPass&, const World&, const Inputs&)>;
    using Execute = std::function<void(FunctionPass&, const Step&, Commands&)>;
    Declare onDeclare;
    Execute onExecute;
    float value = 1;
    std::string name = "?";

    mutable Demand demand = Demand::nothing(); // that it was declared with last

    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& asked) const override {
        demand = asked;
        return onDeclare(*this, world, inputs);
    }
    void execute(const Step& step, Commands& commands) override { onExecute(*this, step, commands); }
};

class ExecuteTest : public GlTest {
protected:
    void SetUp() override {
        GlTest::SetUp();
        registry_.shaderFolders = {folder_.path()};
    }

    // Ports as "in NAME", "in? NAME" (optional), "out NAME", "own NAME" (internal), all textures, or with
    // "buffer " in front buffers.
    void addType(const std::string& name, const std::vector<std::string>& ports,
                 FunctionPass::Declare declare, FunctionPass::Execute execute) {
        Describe<FunctionPass> describe(name, "A test pass");
        for (std::string port : ports) {
            PortKind kind = PortKind::Texture;
            if (port.starts_with("buffer ")) {
                kind = PortKind::Buffer;
                port = port.substr(7);
            }
            const std::string way = port.substr(0, port.find(' ')), label = port.substr(port.find(' ') + 1);
            if (way == "in") describe.input(label, kind, "An input");
            if (way == "in?") describe.optionalInput(label, kind, "An input");
            if (way == "out") describe.output(label, kind, "An output");
            if (way == "own") describe.internal(label, kind, "Its own");
        }
        describe.number("value", &FunctionPass::value, -1e9, 1e9, "", "A number");
        describe.text("name", &FunctionPass::name, "What its runs are counted by");
        PassType type = describe;
        type.make = [declare, execute] {
            auto pass = std::make_unique<FunctionPass>();
            pass->onDeclare = declare;
            pass->onExecute = execute;
            return pass;
        };
        registry_.add(std::move(type));
    }

    void shader(const std::string& file, const std::string& text) { writeFile(folder_ / file, text); }

    // `passes`: "name: Type" or "name: Type = value"; edges: "a.b > c.d".
    [[nodiscard]] Graph graphOf(const std::vector<std::string>& passes, const std::vector<std::string>& edges,
                                const std::vector<std::string>& outputs) const {
        Graph graph;
        graph.name = "test";
        for (const std::string& text : passes) {
            GraphPass pass;
            const size_t colon = text.find(": "), equals = text.find(" = ");
            pass.name = text.substr(0, colon);
            pass.type = text.substr(colon + 2, equals == std::string::npos ? equals : equals - colon - 2);
            if (equals != std::string::npos)
                pass.properties.emplace_back("value", std::stod(text.substr(equals + 3)));
            pass.properties.emplace_back("name", pass.name);
            graph.passes.push_back(pass);
        }
        for (const std::string& text : edges) {
            const size_t arrow = text.find(" > ");
            graph.edges.push_back({parsePortRef(text.substr(0, arrow)).value(),
                                   parsePortRef(text.substr(arrow + 3)).value(),
                                   {}});
        }
        for (const std::string& text : outputs) graph.outputs.push_back({parsePortRef(text).value(), {}});
        return graph;
    }

    // A unit quad in the plane z = 0, seen head-on; with `moving` it slides along x for a second.
    [[nodiscard]] static Scene quadScene(bool moving = false) {
        Scene scene;
        scene.name = "quad";
        Primitive quad;
        quad.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
        quad.normals.assign(4, {0, 0, 1});
        quad.indices = {0, 1, 2, 0, 2, 3};
        scene.meshes.push_back({"quad", {quad}, {}});
        for (const char* name : {"front", "right"}) {
            Camera camera;
            camera.name = name;
            camera.node = static_cast<int>(scene.cameras.size()) + 1;
            scene.cameras.push_back(camera);
        }
        Node mesh, front, right;
        mesh.mesh = 0;
        front.camera = 0;
        front.translation = {0, 0, 3};
        right.camera = 1;
        right.translation = {1, 0, 3};
        scene.nodes = {mesh, front, right};
        scene.roots = {0, 1, 2};
        if (moving) {
            AnimationChannel slide;
            slide.node = 0;
            slide.times = {0, 1};
            slide.values = {0, 0, 0, 1, 0, 0};
            scene.animations.push_back({"slide", {slide}});
        }
        finishScene(scene);
        return scene;
    }

    [[nodiscard]] std::unique_ptr<Renderer> rendererOf(const Graph& graph, RenderOptions options = {},
                                                       Scene scene = quadScene()) const {
        if (options.size == RenderOptions{}.size) options.size = {8, 4, 1};
        return std::make_unique<Renderer>(graph, registry_, std::move(scene), context().capabilities(),
                                          options);
    }

    // An image of the frame's size.
    static Output imageOf(const World& world, const std::string& port, Format format = Format::R32F) {
        return {.port = port, .desc = Desc::texture2D(format, world.extentOf({}))};
    }
    static Step stepOf(const std::string& name, const std::vector<std::string>& shaders,
                       const std::vector<Use>& uses) {
        Step step;
        step.name = name;
        step.shaders = shaders;
        step.uses = uses;
        return step;
    }
    static Use write(const std::string& port, Access access = Access::Image) {
        return {.port = port, .access = access, .write = true};
    }
    static Use read(const std::string& port, Access access = Access::Image) {
        return {.port = port, .access = access};
    }
    static void overFrame(Commands& commands) { commands.dispatchOver(commands.frame().size); }

    // "Fill": writes `value` everywhere; "FrameFill": as that, but in every frame; "Add": input plus value.
    void addArithmetic() {
        shader("fill.comp", R"(layout(local_size_x = 8, local_size_y = 8) in;
            layout(r32f) uniform writeonly image2D result;
            uniform float value;
            void main() { imageStore(result, ivec2(gl_GlobalInvocationID.xy), vec4(value)); })");
        shader("add.comp", R"(layout(local_size_x = 8, local_size_y = 8) in;
            layout(r32f) uniform readonly image2D signal;
            layout(r32f) uniform writeonly image2D result;
            uniform float value;
            void main() {
                ivec2 p = ivec2(gl_GlobalInvocationID.xy);
                imageStore(result, p, imageLoad(signal, p) + value);
            })");
        for (const bool everyFrame : {false, true})
            addType(
                everyFrame ? "FrameFill" : "Fill", {"out result"},
                [everyFrame](const FunctionPass&, const World& world, const Inputs&) {
                    Declaration declaration;
                    declaration.outputs = {imageOf(world, "result")};
                    declaration.steps = {stepOf("fill", {"fill.comp"}, {write("result")})};
                    if (everyFrame) declaration.depends = Causes::Frame;
                    return declaration;
                },
                [this](FunctionPass& pass, const Step&, Commands& commands) { count(pass, commands); });
        addType(
            "Add", {"in signal", "out result"},
            [](const FunctionPass&, const World& world, const Inputs&) {
                Declaration declaration;
                declaration.outputs = {imageOf(world, "result")};
                declaration.steps = {stepOf("add", {"add.comp"}, {read("signal"), write("result")})};
                return declaration;
            },
            [this](FunctionPass& pass, const Step&, Commands& commands) { count(pass, commands); });
    }

    void count(FunctionPass& pass, Commands& commands) {
        ++runs_[pass.name];
        causes_[pass.name] = commands.causes();
        commands.set("value", pass.value);
        overFrame(commands);
    }

    TemporaryFolder folder_;
    Registry registry_;
    std::map<std::string, int> runs_;
    std::map<std::string, Causes> causes_;
};

} // namespace kestrel::test
