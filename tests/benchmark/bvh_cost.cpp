// The hierarchy in GLSL, wide and binary, beside Embree, ROMA and a tracer that answers at once (roma, none):
// any hits of hemisphere rays, closest hits of camera rays, any hits within an effect, in turn; and how many
// words of the answers are others than the first form's. Times of all threads together hold better on a busy
// machine; making the rays is in them. Run by hand: [FORMS="binary wide embree"] [KINDS="any closest inside"]
// [HEIGHT=720] build/bin/benchmark_bvh_cost [FRAMES [SCENE...]]
#include "core/files.h"
#include "core/spin.h"
#include "execute/renderer.h"
#include "gl/context.h"
#include "graph/graph.h"
#include "plugin/loader.h"
#include "scene/builtin.h"
#include "scene/scene.h"
#include "shared/ray.h"
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fmt/format.h>
#include <iterator>
#include <memory>
#include <sstream>

namespace kestrel {
namespace {

struct CameraRays final : Pass {
    static PassType type() {
        return Describe<CameraRays>("CameraRays", "One ray a pixel from the camera, as a buffer")
            .input("depth", PortKind::Texture, "Whose pixels")
            .output("rays", PortKind::Buffer, "One record a pixel in rows from the bottom (shared/ray.h)")
            .carries(content::elements("RayRecord"));
    }
    [[nodiscard]] Declaration declare(const World&, const Inputs& inputs, const Demand&) const override {
        Declaration declaration;
        const Extent extent = inputs["depth"].desc.extent;
        const std::uint64_t pixels = std::uint64_t{extent.width} * extent.height;
        declaration.outputs = {
            {.port = "rays", .desc = Desc::buffer(pixels * sizeof(shared::RayRecord), Format::RGBA32UI)}};
        declaration.steps = {{.name = "generate",
                              .shaders = {"benchmark/camera_rays.comp"},
                              .uses = {{.port = "depth", .access = Access::Fetch},
                                       {.port = "rays", .access = Access::Storage, .write = true}}}};
        declaration.depends = Causes::Frame;
        return declaration;
    }
    void execute(const Step&, Commands& commands) override {
        commands.dispatchOver(commands.desc("depth").extent);
    }
};

// One query by one form. Rays are new in each frame, the same of all forms.
std::string graphText(const std::string& kind, const std::string& form) {
    const bool embree = form == "embree";
    const std::string rays = kind == "closest" ? "seen" : "around";
    std::string text = R"({"kestrel": 1, "passes": {"gbuffer": {"type": "GBuffer"},
        "around": {"type": "HemisphereRays"}, "seen": {"type": "CameraRays"},)";
    const std::string query = kind == "closest" ? "closest" : "any";
    if (form == "roma")
        text +=
            R"("bom": {"type": "OccupancyMap", "properties": {"method": "exact"}}, "bvh": {"type": "Roma"},)";
    else if (form == "none")
        text += R"("bvh": {"type": "ConstantTracer"},)";
    else if (!embree)
        text += fmt::format(R"("bvh": {{"type": "Bvh", "properties": {{"layout": "{}"}}}},)", form);
    if (kind == "inside")
        text += R"("query": {"type": "RayAmbientOcclusion", "properties": {"rays": 1}}},)";
    else
        text += fmt::format(R"("query": {{"type": "{}RayQuery", "properties": {{"query": "{}"{}}}}}}},)",
                            embree ? "Reference" : "", query, form == "roma" ? R"(, "snap": true)" : "");
    text += R"("edges": [["gbuffer.depth", "around.depth"], ["gbuffer.normal", "around.normal"],
        ["gbuffer.face_normal", "around.face_normal"], ["gbuffer.depth", "seen.depth"])";
    if (kind == "inside")
        text += R"(, ["gbuffer.depth", "query.depth"], ["gbuffer.normal", "query.normal"],
            ["gbuffer.face_normal", "query.face_normal"])";
    else
        text += fmt::format(R"(, ["{}.rays", "query.rays"])", rays);
    if (!embree) text += R"(, ["bvh.tracer", "query.tracer"])";
    if (form == "roma") text += R"(, ["bom.occupancy", "bvh.occupancy"], ["bom.grid", "bvh.grid"])";
    const char* output = kind == "inside" ? "visibility" : kind == "any" && !embree ? "distance" : "hits";
    return text + fmt::format(R"(], "outputs": ["query.{}"]}})", output);
}

double cpuMs() {
    std::timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

struct Run {
    std::string kind, form;
    std::unique_ptr<Renderer> renderer;
    std::vector<double> wall = {}, cpu = {}; // of tracing; of all that the frame did
    double build = 0;
    std::vector<std::byte> answers = {};
};

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

std::vector<double> ratios(const std::vector<double>& over, const std::vector<double>& under) {
    std::vector<double> result;
    for (std::size_t i = 0; i < over.size(); ++i) result.push_back(over[i] / under[i]);
    return result;
}

void measure(const gl::Context& context, const Registry& registry, const std::string& source, int frames,
             const std::vector<std::string>& forms, const std::vector<std::string>& kinds,
             std::uint32_t height) {
    RenderOptions options;
    options.size = {height * 16 / 9, height, 1};
    options.timing = true;
    const Scene scene = loadScene(source);
    fmt::print("{}\n", source);
    for (const std::string& kind : kinds) {
        std::vector<Run> runs;
        for (const std::string& form : forms) {
            if (kind == "inside" && form == "embree") continue;
            runs.push_back({kind, form,
                            std::make_unique<Renderer>(parseGraph(graphText(kind, form), "bvh_cost"),
                                                       registry, scene, context.capabilities(), options)});
        }
        for (int i = -1; i < frames; ++i)
            for (Run& run : runs) {
                const double before = cpuMs();
                const auto& samples = run.renderer->frame().samples;
                const double cpu = cpuMs() - before;
                double wall = 0;
                for (const StepSample& sample : samples) {
                    if (sample.pass == "query" && sample.step.starts_with("trace")) wall += sample.ms;
                    if (sample.step == "build" && i < 0) run.build = sample.ms;
                }
                if (i < 0) continue;
                run.wall.push_back(wall);
                run.cpu.push_back(cpu);
            }
        for (Run& run : runs) {
            fmt::print("  {:8} {:8} {:9.2f} ms, {:5.2f} times as fast; of all threads {:9.2f} ms, {:5.2f}; "
                       "build {:7.1f}",
                       kind, run.form, median(run.wall), median(ratios(runs[0].wall, run.wall)),
                       median(run.cpu), median(ratios(runs[0].cpu, run.cpu)), run.build);
            const char* output = kind == "inside" ? "visibility" : kind == "any" ? "distance" : "hits";
            if (run.form != "embree") run.answers = run.renderer->readBytes({"query", output});
            std::size_t differ = 0;
            for (std::size_t at = 0; at < run.answers.size(); at += 4)
                if (std::memcmp(&run.answers[at], &runs[0].answers[at], 4) != 0) ++differ;
            fmt::print("; {} words differ\n", differ);
        }
    }
}

std::vector<std::string> words(const char* name, const std::string& otherwise) {
    const char* value = std::getenv(name);
    std::istringstream stream(value ? value : otherwise);
    return {std::istream_iterator<std::string>(stream), {}};
}

int run(int frames, std::vector<std::string> scenes) {
    const auto context = gl::Context::create();
    Registry registry;
    loadPlugins(registry, pluginFolders());
    registry.shaderFolders.emplace_back(KESTREL_BENCHMARK_SHADERS);
    registry.add(CameraRays::type());
    if (scenes.empty()) scenes = {"builtin:blob", "builtin:tower", "builtin:hall", "builtin:grove"};
    const SpinTest spin = measureSpin();
    fmt::print("spin test: {:.1f} ms on one thread, {:.1f} ms on two at once\n", spin.oneThreadMs,
               spin.twoThreadsMs);
    for (const std::string& scene : scenes)
        measure(*context, registry, scene, frames, words("FORMS", "binary wide embree"),
                words("KINDS", "any closest inside"),
                static_cast<std::uint32_t>(std::stoi(words("HEIGHT", "720")[0])));
    return 0;
}

} // namespace
} // namespace kestrel

int main(int count, char** arguments) {
    return kestrel::run(count > 1 ? std::atoi(arguments[1]) : 9,
                        count > 2 ? std::vector<std::string>(arguments + 2, arguments + count)
                                  : std::vector<std::string>{});
}
