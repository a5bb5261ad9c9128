// What ambient occlusion from the depth buffer costs beside its fetches: AmbientOcclusionFirst and a pass
// that only adds up the depths at the same places, in turn. Run by hand: build/bin/benchmark_occlusion_cost
// [FRAMES].
#include "core/files.h"
#include "execute/renderer.h"
#include "gl/context.h"
#include "graph/graph.h"
#include "plugin/loader.h"
#include "scene/builtin.h"
#include "scene/scene.h"
#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <map>

namespace kestrel {
namespace {

struct DepthFetches final : Pass {
    static PassType type() {
        return Describe<DepthFetches>("DepthFetches",
                                      "Adds up the depths at the samples of ambient occlusion")
            .input("view_depth", PortKind::Texture, "As AmbientOcclusionFirst reads it")
            .input("normal", PortKind::Texture, "As AmbientOcclusionFirst reads it")
            .input("settings", PortKind::Buffer, "Of AmbientOcclusionFirst")
            .output("sum", PortKind::Texture, "Of the depths");
    }
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand&) const override {
        Declaration declaration;
        View inner = inputs["view_depth"].desc.view;
        inner.guard = 0;
        declaration.outputs = {
            {.port = "sum", .desc = Desc::texture2D(Format::R16F, world.extentOf(inner), inner)}};
        declaration.steps = {{.name = "add",
                              .shaders = {"benchmark/depth_fetches.comp"},
                              .defines = {{"SAMPLES", "8"}, {"KERNEL_VAO", "1"}},
                              .uses = {{.port = "view_depth", .access = Access::Image},
                                       {.port = "normal", .access = Access::Image},
                                       {.port = "settings", .access = Access::Uniform},
                                       {.port = "sum", .access = Access::Image, .write = true}}}};
        return declaration;
    }
    void execute(const Step&, Commands& commands) override {
        commands.dispatchOver(commands.desc("sum").extent);
    }
};

int run(int frames) {
    const auto context = gl::Context::create();
    Registry registry;
    loadPlugins(registry, pluginFolders());
    registry.shaderFolders.emplace_back(KESTREL_BENCHMARK_SHADERS);
    registry.add(DepthFetches::type());
    const Graph graph = parseGraph(R"({"kestrel": 1, "passes": {
        "gbuffer": {"type": "GBuffer", "properties": {"guard": 64}},
        "occlusion": {"type": "AmbientOcclusionFirst"}, "fetches": {"type": "DepthFetches"}},
        "edges": [["gbuffer.view_depth", "occlusion.view_depth"], ["gbuffer.normal", "occlusion.normal"],
            ["gbuffer.view_depth", "fetches.view_depth"], ["gbuffer.normal", "fetches.normal"],
            ["occlusion.settings", "fetches.settings"]],
        "outputs": ["occlusion.visibility", "fetches.sum"]})",
                                   "occlusion_cost");
    RenderOptions options;
    options.size = {1280, 720, 1};
    options.timing = true;
    Renderer renderer(graph, registry, loadScene("builtin:blob"), context->capabilities(), options);
    std::map<std::string, std::vector<double>> times;
    for (int i = -2; i < frames; ++i) {
        renderer.restart();
        for (const StepSample& sample : renderer.frame().samples)
            if (i >= 0) times[sample.pass + "." + sample.step].push_back(sample.ms);
    }
    const auto median = [](std::vector<double> values) {
        std::sort(values.begin(), values.end());
        return values[values.size() / 2];
    };
    for (const auto& [step, ms] : times) {
        const auto [least, most] = std::minmax_element(ms.begin(), ms.end());
        fmt::print("{:24} {:7.2f} ms ({:.2f} to {:.2f})\n", step, median(ms), *least, *most);
    }
    // Within a frame, so that a machine that changes its speed changes both.
    std::vector<double> ratios;
    for (size_t i = 0; i < times["fetches.add"].size(); ++i)
        ratios.push_back(times["occlusion.first"][i] / times["fetches.add"][i]);
    fmt::print("first pass over fetches, median of the frames: {:.2f}\n", median(ratios));
    return 0;
}

} // namespace
} // namespace kestrel

int main(int count, char** arguments) { return kestrel::run(count > 1 ? std::atoi(arguments[1]) : 15); }
