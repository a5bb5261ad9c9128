// What storing an A-buffer costs beside a plain colour raster of the same fragments (same views, same
// viewports, no depth test), its ways in turn within each frame. Run by hand:
// build/bin/benchmark_abuffer_store [FRAMES [SCENE [WIDTH HEIGHT]]].
#include "core/files.h"
#include "execute/renderer.h"
#include "gl/context.h"
#include "passes/abuffer/views.h"
#include "plugin/loader.h"
#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <map>

namespace kestrel {
namespace {

// Every fragment as a colour.
struct PlainRaster final : Pass {
    static PassType type() {
        return Describe<PlainRaster>("PlainRaster", "Draws the views of an A-buffer in one colour")
            .input("bounds", PortKind::Texture, "Of ABufferBounds: which views there are")
            .output("frame", PortKind::Texture, "A colour")
            .output("faces", PortKind::Texture, "A colour");
    }
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand&) const override {
        const FragmentLists lists = inputs["bounds"].desc.lists;
        const auto side = static_cast<std::uint32_t>(lists.side);
        Declaration declaration;
        declaration.outputs = {
            {.port = "frame", .desc = Desc::texture2D(Format::RGBA8, world.size), .clear = glm::vec4(0)},
            {.port = "faces",
             .desc = Desc::array2D(Format::RGBA8, {side, side, shared::abufferFaces}),
             .clear = glm::vec4(0)}};
        for (const bool faces : {false, true}) {
            const ABufferViews views = faces ? ABufferViews::Faces : ABufferViews::Frame;
            Step step =
                abufferSceneStep(world, lists, views, ABufferDrawing::ByView, true, "benchmark/plain.frag");
            step.uses = {{.port = faces ? "faces" : "frame", .access = Access::Attachment, .write = true}};
            step.defines.emplace("VIEW_BLOCK", faces ? "FacesView" : "FrameView");
            step.defines.emplace("OUTPUT", faces ? "out_faces" : "out_frame");
            step.run = [lists, views](Commands& commands) {
                abufferDrawScene(commands, DrawState::overwrite(), lists, commands.frame().size, views,
                                 ABufferDrawing::ByView, true);
            };
            declaration.steps.push_back(std::move(step));
        }
        declaration.depends = Causes::Frame;
        return declaration;
    }
};

// One store a line: its name and settings.
const std::pair<const char*, std::vector<const char*>> stores[] = {
    {"counter", {"allocation=counter"}},
    {"pages", {"allocation=pages"}},
    {"counted", {"allocation=counted"}},
    {"counted_by_atomics", {"allocation=counted", "fetch=false"}},
    {"counter_without_planes", {"allocation=counter", "planes=false"}},
    {"counted_without_planes", {"allocation=counted", "planes=false"}},
    {"counted_whole", {"allocation=counted", "decoupled=false"}},
    {"by_geometry_shader", {"allocation=counted", "drawing=geometry_shader"}},
    {"by_vertex_layer", {"allocation=counted", "drawing=vertex_layer"}},
};

int run(int frames, const std::string& scene, Extent size) {
    const auto context = gl::Context::create();
    Registry registry;
    loadPlugins(registry, pluginFolders());
    registry.shaderFolders.emplace_back(KESTREL_BENCHMARK_SHADERS);
    registry.add(PlainRaster::type());
    Graph graph = parseGraph(R"({"kestrel": 1, "passes": {
        "bounds": {"type": "ABufferBounds", "properties": {"count_layers": true}},
        "bounds_of_boxes": {"type": "ABufferBounds", "properties": {"source": "proxy"}},
        "bounds_by_geometry_shader": {"type": "ABufferBounds", "properties": {"drawing": "geometry_shader"}},
        "bounds_by_vertex_layer": {"type": "ABufferBounds", "properties": {"drawing": "vertex_layer"}},
        "plain": {"type": "PlainRaster"}},
        "edges": [["bounds.bounds", "plain.bounds"]],
        "outputs": ["plain.frame", "plain.faces"]})",
                             "abuffer_store");
    const auto connect = [&](const std::string& to, const std::string& from) {
        applySetting(graph, registry, to + "=" + from);
    };
    const auto output = [&](const std::string& pass, const char* port) {
        graph.outputs.push_back({{pass, port}, {}});
    };
    for (const std::string pass : {"bounds_of_boxes", "bounds_by_geometry_shader", "bounds_by_vertex_layer"})
        for (const char* port : {"bounds", "cube_bounds"}) output(pass, port);
    for (const auto& [name, settings] : stores) {
        const std::string store = name;
        GraphPass pass;
        pass.name = store;
        pass.type = "ABufferStore";
        graph.passes.push_back(pass);
        pass.name = store + "_reorder";
        pass.type = "ABufferReorder";
        graph.passes.push_back(pass);
        connect(store + ".bounds", "bounds.bounds");
        connect(store + ".cube_bounds", "bounds.cube_bounds");
        connect(store + "_reorder.stored_pixels", store + ".pixels");
        connect(store + "_reorder.stored_nodes", store + ".nodes");
        connect(store + "_reorder.data", store + ".data");
        connect(store + "_reorder.segments", store + ".segments");
        for (const char* setting : settings)
            applySetting(graph, registry, fmt::format("{}.{}", store, setting));
        for (const char* port : {"pixels", "nodes", "triangles"}) output(store + "_reorder", port);
    }
    RenderOptions options;
    options.size = size;
    options.timing = true;
    Renderer renderer(graph, registry, loadScene(scene), context->capabilities(), options);
    std::map<std::string, std::vector<double>> times; // by pass, and by pass and step
    for (int i = -2; i < frames; ++i) {
        renderer.restart();
        std::map<std::string, double> sums;
        for (const StepSample& sample : renderer.frame().samples) {
            if (sample.group == "report") continue;
            sums[sample.pass] += sample.ms;
            sums[fmt::format("{}.{}", sample.pass, sample.step)] += sample.ms;
        }
        for (const auto& [what, ms] : sums)
            if (i >= 0) times[what].push_back(ms);
    }
    const auto median = [](std::vector<double> values) {
        std::sort(values.begin(), values.end());
        return values[values.size() / 2];
    };
    fmt::print("{}, {}x{}", scene, size.width, size.height);
    for (const auto& [key, value] : renderer.last().values.at("bounds"))
        fmt::print(", {} {:.2f}", key, value);
    fmt::print("\n");
    for (const auto& [what, ms] : times) {
        const auto [least, most] = std::minmax_element(ms.begin(), ms.end());
        if (*most < 2) continue;
        fmt::print("{:36} {:8.2f} ms ({:.2f} to {:.2f})\n", what, median(ms), *least, *most);
    }
    // Within a frame, so that a machine that changes its speed changes both.
    for (const auto& [name, settings] : stores) {
        std::vector<double> counter, plain;
        for (size_t i = 0; i < times[name].size(); ++i) {
            counter.push_back(times[name][i] / times["counter"][i]);
            plain.push_back(times[name][i] / times["plain"][i]);
        }
        fmt::print("{:36} {:8.2f} of the one counter's {:8.2f} of the plain raster's\n", name,
                   median(counter), median(plain));
    }
    return 0;
}

} // namespace
} // namespace kestrel

int main(int count, char** arguments) {
    const auto number = [&](int at, int otherwise) {
        return count > at ? std::atoi(arguments[at]) : otherwise;
    };
    return kestrel::run(
        number(1, 9), count > 2 ? arguments[2] : "builtin:lattice",
        {static_cast<std::uint32_t>(number(3, 640)), static_cast<std::uint32_t>(number(4, 360)), 1});
}
