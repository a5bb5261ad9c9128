// `kestrel render`: a graph on a scene, headless, into files.
#include "commands.h"
#include "common.h"
#include "core/files.h"
#include "core/progress.h"
#include "execute/renderer.h"
#include "gl/context.h"
#include "graph/report.h"
#include "measure/run_stats.h"
#include "output_files.h"
#include <fmt/format.h>
#include <memory>

namespace kestrel {

namespace {

struct RenderArguments : GraphArguments {
    int frames = 1;
    std::uint32_t seed = 0;
    std::string folder, stats, backend = "egl";
    std::vector<std::string> outputs;
    bool keepAll = false, noSharing = false, checkFinite = false, still = false;
};

void renderFrames(Renderer& renderer, int frames, Profile& profile, ProgressBar& progress) {
    for (int i = 0; i < frames; ++i) {
        progress.update(static_cast<double>(i) / frames, fmt::format("frame {} of {}", i + 1, frames));
        profile.add(renderer.frame());
    }
    progress.clear();
}

void printRun(const Renderer& renderer, const Profile& profile, const FileBytes& files) {
    for (const auto& [file, bytes] : files) fmt::print("{} ({})\n", file.string(), bytesText(bytes.size()));
    const Spread frame = profile.frame();
    fmt::print("time: {} frame{}, median {:.2f} ms, {:.2f} to {:.2f} ({})\n", profile.frameCount(),
               profile.frameCount() == 1 ? "" : "s", frame.median, frame.min, frame.max,
               renderer.capabilities().renderer);
    for (const Profile::PassTime& pass : profile.passes())
        fmt::print("time of {}: median {:.2f} ms, ran in {} of {} frames\n", pass.name, pass.ms.median,
                   pass.runs, profile.frameCount());
    for (const auto& [pass, values] : renderer.last().values)
        for (const auto& [key, value] : values) fmt::print("{}: {} = {}\n", pass, key, value);
    fmt::print("memory: {}\n{}", memoryText(renderer.plan().memory), leftOutText(renderer.plan().leftOut));
}

int render(const RenderArguments& arguments) {
    const Registry& registry = loadedRegistry();
    const Graph graph = openGraph(arguments, registry);
    RenderOptions options;
    options.size = parseSize(arguments.size);
    options.seed = arguments.seed;
    options.camera = arguments.camera;
    options.keepAll = arguments.keepAll;
    options.shareMemory = !arguments.noSharing;
    options.checkFinite = arguments.checkFinite;
    options.timing = !arguments.stats.empty();
    options.finishFrames = true;
    std::vector<OutputFile> outputs;
    for (const std::string& text : arguments.outputs) {
        outputs.push_back(parseOutput(text));
        options.previews.push_back(outputs.back().port);
    }
    Scene scene = openScene(arguments, graph);

    const auto context = gl::Context::create({.backend = gl::backendFromName(arguments.backend)});
    ProgressBar progress("render");
    options.progress = [&](const std::string& step, double fraction) { progress.update(fraction, step); };
    Renderer renderer(graph, registry, std::move(scene), context->capabilities(), options);
    renderer.setPaused(arguments.still);
    for (const OutputFile& output : outputs) static_cast<void>(renderer.desc(output.port));

    Profile profile;
    renderFrames(renderer, arguments.frames, profile, progress);

    FileBytes files;
    for (const OutputFile& output : outputs) addOutput(files, renderer, registry, output);
    if (!arguments.folder.empty() || outputs.empty())
        addGraphOutputs(files, renderer, registry, arguments.folder.empty() ? "." : arguments.folder);
    if (!arguments.stats.empty()) {
        const std::string json = statsJson(gatherStats(renderer, profile, context->driver()));
        const auto bytes = std::as_bytes(std::span(json));
        files.emplace_back(arguments.stats, std::vector<std::byte>(bytes.begin(), bytes.end()));
    }
    writeAll(files);
    printRun(renderer, profile, files);
    return static_cast<int>(ExitStatus::Done);
}

} // namespace

void addRenderCommand(CLI::App& app, Run& run) {
    CLI::App* command = app.add_subcommand("render", "Render a graph into image files");
    const auto arguments = std::make_shared<RenderArguments>();
    addGraphArguments(*command, *arguments);
    command->add_option("--frames,-n", arguments->frames, "How many frames")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    command->add_option("--seed", arguments->seed, "Seed of all random numbers")->capture_default_str();
    command->add_option(
        "--out,-o", arguments->folder,
        "Folder for the graph's outputs, as pass.port.png (with .exr beside it where values lie "
        "outside [0, 1]); default: here, unless --output is given");
    command
        ->add_option("--output", arguments->outputs,
                     "pass.port=FILE: writes any port, as PNG, HDR, EXR or raw bytes by the file's ending "
                     "(.png, .hdr, .exr, .bin); may be given several times")
        ->allow_extra_args(false);
    command->add_option("--stats", arguments->stats, "Write times, memory and what was left out as JSON");
    command->add_flag("--still", arguments->still, "The scene's time stands still at 0");
    command->add_flag("--keep-all", arguments->keepAll, "Leave nothing out");
    command->add_flag("--no-sharing", arguments->noSharing, "Give each resource memory of its own");
    command->add_flag("--check-finite", arguments->checkFinite,
                      "Stop (exit 1) at the first value that is not a number, infinite or out of its range, "
                      "naming pass, port and pixel");
    command->add_option("--backend", arguments->backend, "egl, osmesa or window")->capture_default_str();
    command->footer(
        "PNG files hold one and two channels as they are, colours in sRGB.\n\n"
        "Examples:\n"
        "  kestrel render graphs/ray_ao.json --frames 64 --out out\n"
        "  kestrel render graphs/ray_ao.json -s model.glb --set ao.tracer=bvh.tracer --stats s.json\n"
        "  kestrel render graphs/ray_ao.json --output gbuffer.normal=normal.exr");
    command->callback([arguments, &run] { run = [arguments] { return render(*arguments); }; });
}

} // namespace kestrel
