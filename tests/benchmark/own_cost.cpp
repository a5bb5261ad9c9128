// What the framework itself costs: compiling a graph, and a frame of passes that do nothing. Targets: under
// 20 ms a compilation (without shaders) of 60 passes, under 0.1 ms a frame of 20 empty passes with clocks
// off.
#include "execute/renderer.h"
#include "gl/context.h"
#include <benchmark/benchmark.h>
#include <fmt/format.h>

namespace kestrel {
namespace {

// Passes its input on, in one step without a program, every frame.
struct EmptyPass final : Pass {
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand&) const override {
        Declaration declaration;
        declaration.outputs = {
            {.port = "result", .desc = Desc::texture2D(Format::RGBA16F, world.extentOf({}))}};
        Step step;
        step.name = "nothing";
        step.uses = {{.port = "result", .access = Access::Copy, .write = true}};
        for (const char* port : {"a", "b"})
            if (inputs.connected(port)) step.uses.push_back({.port = port, .access = Access::Copy});
        declaration.steps = {step};
        declaration.depends = Causes::Frame;
        return declaration;
    }
    void execute(const Step&, Commands&) override {}
};

Registry emptyRegistry() {
    Registry registry;
    registry.add(Describe<EmptyPass>("Empty", "Does nothing")
                     .optionalInput("a", PortKind::Texture, "An input")
                     .optionalInput("b", PortKind::Texture, "An input")
                     .output("result", PortKind::Texture, "An output"));
    return registry;
}

// Each pass reads the one before it, and the one three before.
Graph chain(int passes) {
    Graph graph;
    graph.name = "chain";
    for (int i = 0; i < passes; ++i) {
        GraphPass pass;
        pass.name = fmt::format("p{}", i);
        pass.type = "Empty";
        graph.passes.push_back(pass);
        if (i > 0) graph.edges.push_back({{fmt::format("p{}", i - 1), "result"}, {pass.name, "a"}, {}});
        if (i > 2) graph.edges.push_back({{fmt::format("p{}", i - 3), "result"}, {pass.name, "b"}, {}});
    }
    graph.outputs.push_back({{fmt::format("p{}", passes - 1), "result"}, {}});
    return graph;
}

void compileGraph(benchmark::State& state) {
    const Registry registry = emptyRegistry();
    const Graph graph = chain(static_cast<int>(state.range(0)));
    const PassSet passes = makePasses(graph, registry);
    const World world;
    for (auto _ : state) benchmark::DoNotOptimize(compile(graph, registry, passes, world));
}
BENCHMARK(compileGraph)->Arg(20)->Arg(60)->Unit(benchmark::kMillisecond);

void emptyFrame(benchmark::State& state) {
    const auto context = gl::Context::create();
    const Registry registry = emptyRegistry();
    Scene scene;
    finishScene(scene);
    Renderer renderer(chain(static_cast<int>(state.range(0))), registry, scene, context->capabilities());
    renderer.frame();
    for (auto _ : state) renderer.frame();
}
BENCHMARK(emptyFrame)->Arg(20)->Arg(60)->Unit(benchmark::kMillisecond);

} // namespace
} // namespace kestrel

BENCHMARK_MAIN();
