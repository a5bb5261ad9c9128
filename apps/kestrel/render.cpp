// `kestrel render`: a graph on a scene, headless, into files.
#include "commands.h"
#include "common.h"
#include "core/files.h"
#include "core/progress.h"
#include "core/standard_output.h"
#include "execute/renderer.h"
#include "gl/context.h"
#include "graph/report.h"
#include "measure/run_stats.h"
#include "output_files.h"
#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <set>
#include <span>

namespace kestrel {

namespace {

struct RenderArguments : GraphArguments {
    int frames = 1, every = 0;
    std::uint32_t seed = 0;
    std::optional<double> timeStep;
    std::string folder, stats, clock, backend = "egl";
    std::vector<std::string> outputs;
    bool keepAll = false, noSharing = false, checkFinite = false, countIterations = false, still = false;
};

// What is written when: sequences as their frames are made, the rest once all are.
class Outputs {
public:
    // Throws InputError with everything that cannot be written, before anything is made.
    Outputs(const RenderArguments& arguments, const Graph& graph)
        : arguments_(arguments) {
        for (const std::string& text : arguments.outputs) take([&] { files_.push_back(parseOutput(text)); });
        if (!arguments.folder.empty() || files_.empty())
            folder_ = arguments.folder.empty() ? "." : arguments.folder;
        for (const OutputFile& output : files_) requireOwn(fileOf(output, 0));
        if (folder_) {
            take([&] { requireWritableFolder(*folder_); });
            for (const GraphOutput& output : graph.outputs) {
                std::filesystem::path file = *folder_ / output.port.text();
                requireOwn(file += mark(0) + ".png");
            }
        }
        if (!arguments.stats.empty()) requireOwn(arguments.stats);
        take([&] { requireNoGraph(arguments, "--stats", arguments.stats); });
        if (folder_ && graph.outputs.empty())
            problems_.push_back({Location{graph.file.string()},
                                 "the graph has no outputs, so there is nothing to write: name a port with "
                                 "--output pass.port=FILE"});
        if (arguments.every > 0 && !folder_ &&
            std::ranges::none_of(files_, [](const OutputFile& output) { return output.sequence; }))
            problems_.push_back({{},
                                 "--every: no output is written more than once: give --out, or --output "
                                 "with the number of the frame in its name, as f_%03d.png"});
        if (!problems_.empty()) throw InputError(std::move(problems_));
    }

    [[nodiscard]] std::vector<PortRef> ports() const {
        std::vector<PortRef> ports;
        for (const OutputFile& output : files_) ports.push_back(output.port);
        return ports;
    }
    // Whether results go to standard output.
    [[nodiscard]] bool streamed() const { return streamed_; }

    // After a frame: the files of sequences.
    void addFrame(Renderer& renderer, const Registry& registry) {
        const std::uint32_t frame = renderer.last().index;
        if (frame % static_cast<std::uint32_t>(std::max(1, arguments_.every)) != 0) return;
        FileBytes made;
        for (const OutputFile& output : files_)
            if (output.sequence) addOutput(made, renderer, registry, output);
        if (folder_ && arguments_.every > 0) addGraphOutputs(made, renderer, registry, *folder_, mark(frame));
        writeFiles(made);
        for (const auto& [file, bytes] : made) written_.emplace_back(file, bytes.size());
    }

    // After the last frame: everything else.
    void addRest(Renderer& renderer, const Registry& registry, const std::string& stats) {
        FileBytes made;
        for (const OutputFile& output : files_)
            if (!output.sequence) addOutput(made, renderer, registry, output);
        if (folder_ && arguments_.every == 0) addGraphOutputs(made, renderer, registry, *folder_);
        if (!arguments_.stats.empty()) {
            const auto bytes = std::as_bytes(std::span(stats));
            made.emplace_back(arguments_.stats, std::vector<std::byte>(bytes.begin(), bytes.end()));
        }
        writeFiles(made);
        for (const auto& [file, bytes] : made) written_.emplace_back(file, bytes.size());
    }

    void print() const {
        for (const auto& [file, size] : written_) say("{} ({})\n", file.string(), bytesText(size));
    }

private:
    template<class F>
    void take(F what) {
        try {
            what();
        } catch (const InputError& error) {
            // Several files of one folder have one cause.
            for (const Problem& problem : error.problems())
                if (std::ranges::find(problems_, problem.text(), &Problem::text) == problems_.end())
                    problems_.push_back(problem);
        }
    }
    // Whether the file can be written, and nothing else is written there.
    void requireOwn(const std::filesystem::path& file) {
        const bool standard = isStandardOutput(file);
        if (standard ? streamed_ : !isStream(file) && !names_.insert(file.lexically_normal()).second)
            problems_.push_back({{},
                                 standard ? "two outputs would go to standard output"
                                          : fmt::format("two outputs would go into {}", file.string())});
        streamed_ |= standard;
        take([&] { requireWritable(file); });
    }
    [[nodiscard]] std::string mark(std::uint32_t frame) const {
        return arguments_.every > 0 ? fmt::format(".{:04}", frame) : std::string();
    }

    const RenderArguments& arguments_;
    std::vector<OutputFile> files_;
    std::optional<std::filesystem::path> folder_; // of the graph's outputs
    std::set<std::filesystem::path> names_;
    bool streamed_ = false;
    std::vector<std::pair<std::filesystem::path, std::uint64_t>> written_;
    std::vector<Problem> problems_;
};

void printRun(const Renderer& renderer, const Profile& profile) {
    const Spread frame = profile.frame();
    say("time: {} frame{}, median {:.2f} ms, {:.2f} to {:.2f} ({})\n", profile.frameCount(),
        profile.frameCount() == 1 ? "" : "s", frame.median, frame.min, frame.max,
        renderer.capabilities().renderer);
    for (const Profile::PassTime& pass : profile.passes())
        say("time of {}: median {:.2f} ms, ran in {} of {} frames\n", pass.name, pass.ms.median, pass.runs,
            profile.frameCount());
    for (const auto& [pass, values] : renderer.last().values)
        for (const auto& [key, value] : values) say("{}: {} = {}\n", pass, key, value);
    say("memory: {}\n{}", memoryText(renderer.plan().memory), leftOutText(renderer.plan().leftOut));
}

int render(const RenderArguments& arguments) {
    const Registry& registry = loadedRegistry();
    const Graph graph = openGraph(arguments, registry);
    RenderOptions options;
    options.size = parseSize(arguments.size);
    options.seed = arguments.seed;
    options.keepAll = arguments.keepAll;
    options.shareMemory = !arguments.noSharing;
    options.checkFinite = arguments.checkFinite;
    options.timeStep = arguments.timeStep;
    options.countIterations = arguments.countIterations;
    options.timing = !arguments.stats.empty();
    if (!arguments.clock.empty()) options.clock = gl::StepClock::kindFromName(arguments.clock);
    options.finishFrames = true;
    Outputs outputs(arguments, graph);
    options.previews = outputs.ports();
    if (outputs.streamed() && reportStream() != nullptr) reportStream() = stderr;
    Scene scene = openScene(arguments, graph);

    const auto context = gl::Context::create({.backend = gl::backendFromName(arguments.backend)});
    ProgressBar progress("render");
    options.progress = [&](const std::string& step, double fraction) { progress.update(fraction, step); };
    Renderer renderer(graph, registry, std::move(scene), context->capabilities(), options);
    renderer.setPaused(arguments.still);
    for (const PortRef& port : outputs.ports()) static_cast<void>(renderer.desc(port));

    Profile profile;
    for (int i = 0; i < arguments.frames; ++i) {
        progress.update(static_cast<double>(i) / arguments.frames,
                        fmt::format("frame {} of {}", i + 1, arguments.frames));
        profile.add(renderer.frame());
        outputs.addFrame(renderer, registry);
    }
    progress.clear();

    std::string stats;
    if (!arguments.stats.empty()) {
        RunStats gathered = gatherStats(renderer, profile, context->driver());
        gathered.graphPath = pathOf(graphFile(arguments.graph).string());
        gathered.scenePath = scenePath(arguments, graph);
        stats = statsJson(gathered);
    }
    outputs.addRest(renderer, registry, stats);
    outputs.print();
    printRun(renderer, profile);
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
    command
        ->add_option("--out,-o", arguments->folder,
                     "Folder for the graph's outputs, as pass.port.png (with .exr beside it where values lie "
                     "outside [0, 1]); default: here, unless --output is given")
        ->check(notEmpty());
    command
        ->add_option("--output", arguments->outputs,
                     "pass.port=FILE: writes any port, as PNG, HDR, EXR or raw bytes by the file's ending "
                     "(.png, .hdr, .exr, .bin); with %03d in its name a file each frame; - and exr:- are "
                     "standard output, as PNG and EXR; may be given several times")
        ->allow_extra_args(false);
    command
        ->add_option("--every", arguments->every,
                     "Write frames 0, N, 2 N, ... of sequences, and with --out all outputs of these, as "
                     "pass.port.0000.png")
        ->check(CLI::Range(1, 1'000'000));
    command->add_option("--stats", arguments->stats, "Write times, memory and what was left out as JSON")
        ->check(notEmpty());
    command->add_option(
        "--clock", arguments->clock,
        "What times the steps for --stats: finish, wall clock between two glFinish, or "
        "timer_query, the GPU's own timestamps, which tell nothing on a CPU renderer; default: what "
        "measures the work here");
    command->add_flag("--still", arguments->still,
                      "The scene's time stands still at that of the first frame");
    command
        ->add_option(
            "--time-step", arguments->timeStep,
            "Seconds of the scene's time from one frame to the next, in place of --fps; 0: it stands "
            "still")
        ->check(CLI::Range(0.0, 1e9))
        ->excludes("--fps");
    command->add_flag("--keep-all", arguments->keepAll, "Leave nothing out");
    command->add_flag("--no-sharing", arguments->noSharing, "Give each resource memory of its own");
    command->add_flag(
        "--check-finite", arguments->checkFinite,
        "Stop (exit 1) at the first frame in which any output of any pass holds a value that is not "
        "a number, infinite or out of its range, naming each such pass and port, the first such "
        "pixel and how many there are; the first that is named is where it began");
    command->add_flag(
        "--count-iterations", arguments->countIterations,
        "Count the iterations of shaders' loops, and stop (exit 1) where one invocation makes more "
        "than every driver runs, naming pass and step");
    command->add_option("--backend", arguments->backend, "egl, osmesa or window")->capture_default_str();
    command->footer(
        "PNG files hold one and two channels as they are, colours in sRGB.\n\n"
        "Examples:\n"
        "  kestrel render graphs/ray_ao.json --frames 64 --out out\n"
        "  kestrel render graphs/ray_ao.json -s model.glb --set ao.tracer=bvh.tracer --stats s.json\n"
        "  kestrel render graphs/ray_ao.json --output gbuffer.normal=normal.exr\n"
        "  kestrel render graphs/ray_ao.json --frames 30 --output 'mean.result=f_%03d.png'\n"
        "  kestrel render graphs/ray_ao.json --camera 'eye=4,3,6 target=0,1,0 fov=50' --light 'sphere "
        "position=0,4,0 radius=0.2'\n"
        "  jq '.passes.bom.properties.resolution=64' graphs/ray_ao.json | kestrel render - --output "
        "mean.result=- | display");
    command->callback([arguments, &run] { run = [arguments] { return render(*arguments); }; });
}

} // namespace kestrel
