// `kestrel stress`: a graph through stiff and extreme cases, each in a process that may crash.
#include "commands.h"
#include "common.h"
#include "core/child_process.h"
#include "core/files.h"
#include "core/hash.h"
#include "core/log.h"
#include "core/progress.h"
#include "core/version.h"
#include "gl/context.h"
#include "measure/stress/stress_limits.h"
#include "measure/stress/stress_workers.h"
#include "measure/sweep_results.h"
#include "studies/stress_curve.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <memory>

namespace kestrel {

namespace {

struct StressArguments : GraphArguments {
    std::string only, json, page, backend = "egl", curve, keep;
    std::vector<double> values;
    double timeout = 120;
    int frames = 0;
    bool list = false, limits = false, resume = false, keepAll = false, worker = false;
};

// What the command line says of graph and scene, again as words.
std::vector<std::string> graphWords(const StressArguments& arguments) {
    std::vector<std::string> words{arguments.graph};
    const auto add = [&](const char* option, const std::string& value) {
        if (!value.empty()) words.insert(words.end(), {option, value});
    };
    add("--scene", arguments.scene);
    add("--camera", arguments.camera);
    for (const std::string& light : arguments.lights) add("--light", light);
    add("--animation", arguments.animation);
    if (arguments.time) add("--time", fmt::format("{}", *arguments.time));
    if (arguments.fps) add("--fps", fmt::format("{}", *arguments.fps));
    add("--size", arguments.size);
    for (const std::string& setting : arguments.settings) add("--set", setting);
    if (arguments.sceneOptions.allowOutside) words.emplace_back("--allow-outside");
    if (arguments.keepAll) words.emplace_back("--keep-all");
    if (arguments.backend != "egl") add("--backend", arguments.backend);
    return words;
}

std::string commandOf(const StressArguments& arguments, const std::string& name) {
    std::vector<std::string> words{"kestrel", "stress"};
    const std::vector<std::string> own = graphWords(arguments);
    words.insert(words.end(), own.begin(), own.end());
    words.insert(words.end(), {"--only", name, "--page", "page"});
    for (std::string& word : words) word = shellWord(word);
    return fmt::format("{}", fmt::join(words, " "));
}

StressRunInfo infoOf(const StressArguments& arguments, const Graph& graph, const Scene& scene) {
    Fnv1a hash;
    for (const std::string& word : graphWords(arguments)) hash.add(word + "\n");
    hash.add(saveGraph(graph));
    const std::string source = scenePath(arguments, graph);
    hash.add(source);
    if (!source.starts_with("builtin:")) hash.add(readText(source));
    for (const Mesh& mesh : scene.meshes)
        for (const Primitive& primitive : mesh.primitives)
            hash.add(std::as_bytes(std::span(primitive.positions)));
    hash.add(version() + configuration());
    return {pathOf(graphFile(arguments.graph).string()),
            source,
            arguments.size,
            fmt::format("{:016x}", hash.value()),
            {}};
}

int serve(const StressArguments& arguments) {
    const Registry& registry = loadedRegistry();
    const Graph graph = openGraph(arguments, registry);
    Scene scene = openScene(arguments, graph);
    StressOptions options;
    options.size = parseSize(arguments.size);
    options.keepAll = arguments.keepAll;
    if (!arguments.page.empty()) options.pictures = std::filesystem::path(arguments.page) / "pictures";
    options.keep = arguments.keep;
    if (arguments.frames > 0) options.frames = arguments.frames;
    const auto context = gl::Context::create({.backend = gl::backendFromName(arguments.backend)});
    return serveStressCases(
        context->capabilities().renderer, [&](std::function<void(const std::string&)> begins) {
            options.begins = std::move(begins);
            return StressRunner(graph, std::move(scene), registry, context->capabilities(), options);
        });
}

void printList(const std::vector<size_t>& chosen) {
    for (const size_t index : chosen) {
        const StressCase& one = stressCases()[index];
        fmt::print("{:<32} {}\n", one.name, one.does);
    }
    fmt::print("{} cases\n", chosen.size());
}

// "92 cases: 90 held, 1 missed, 1 hung".
std::string summary(const std::vector<StressResult>& results) {
    std::map<std::string_view, int> counts;
    size_t checks = 0;
    for (const StressResult& result : results) {
        ++counts[stressOutcomeName(result.outcome)];
        checks += result.checks.size();
    }
    std::string text;
    for (const auto& [outcome, count] : counts)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, outcome);
    return fmt::format("{} cases: {}; {} checks of outputs", results.size(), text, checks);
}

void write(const StressArguments& arguments, const StressRunInfo& info,
           const std::vector<StressResult>& results) {
    if (!arguments.json.empty()) writeFile(arguments.json, stressJson(info, results));
    if (!arguments.page.empty())
        writeFile(std::filesystem::path(arguments.page) / "index.html", stressPage(info, results));
}

int curve(const StressArguments& arguments, bool sizeGiven) {
    std::vector<std::string> worker{ownProgram(), "--quiet", "stress"};
    if (arguments.keepAll) worker.emplace_back("--keep-all");
    if (arguments.backend != "egl") worker.insert(worker.end(), {"--backend", arguments.backend});
    static_cast<void>(gl::backendFromName(arguments.backend));
    return drawCurve(arguments, {.curve = arguments.curve,
                                 .only = arguments.only,
                                 .json = arguments.json,
                                 .page = arguments.page,
                                 .values = arguments.values,
                                 .sizeGiven = sizeGiven,
                                 .frames = arguments.frames,
                                 .timeout = arguments.timeout,
                                 .worker = std::move(worker)});
}

int stress(const StressArguments& arguments, bool sizeGiven) {
    if (arguments.worker) return serve(arguments);
    if (arguments.limits) {
        fmt::print("{}", stressLimitsMarkdown());
        return static_cast<int>(ExitStatus::Done);
    }
    const std::vector<size_t> chosen =
        arguments.curve.empty() ? chooseStressCases(arguments.only) : std::vector<size_t>();
    if (arguments.list) {
        printList(chosen);
        return static_cast<int>(ExitStatus::Done);
    }
    if (arguments.frames > 0 && arguments.curve.empty())
        throw InputError("--frames is of --curve: other cases have as many frames as they need");
    if (arguments.graph.empty()) throw InputError("GRAPH is missing: the graph file");
    if (isStream(arguments.graph))
        throw InputError(Location{arguments.graph},
                         "is read once, and each process that runs cases reads the graph: "
                         "give a file");
    requireNoGraph(arguments, "--json", arguments.json);
    if (!arguments.curve.empty()) return curve(arguments, sizeGiven);
    static_cast<void>(parseSize(arguments.size));
    static_cast<void>(gl::backendFromName(arguments.backend));
    StressRunInfo info;
    {
        const Graph graph = openGraph(arguments, loadedRegistry());
        info = infoOf(arguments, graph, openScene(arguments, graph));
    }
    if (!arguments.json.empty()) requireWritable(arguments.json);
    if (!arguments.page.empty()) requireWritableFolder(arguments.page);
    std::vector<StressResult> results;
    std::error_code ignored;
    if (arguments.resume && arguments.json.empty())
        throw InputError("--resume needs --json: the results so far");
    if (arguments.resume && std::filesystem::exists(arguments.json, ignored))
        results = readStressResults(arguments.json, info);

    std::vector<std::string> command{ownProgram(), "--quiet", "stress"};
    const std::vector<std::string> words = graphWords(arguments);
    command.insert(command.end(), words.begin(), words.end());
    if (!arguments.page.empty()) command.insert(command.end(), {"--page", arguments.page});
    command.emplace_back("--worker");
    StressWorkers workers(command, arguments.timeout);
    info.renderer = workers.renderer();

    ProgressBar progress("stress");
    for (size_t i = 0; i < chosen.size(); ++i) {
        const StressCase& one = stressCases()[chosen[i]];
        if (std::ranges::find(results, one.name, &StressResult::name) != results.end()) continue;
        progress.update(static_cast<double>(i) / static_cast<double>(chosen.size()), one.name);
        StressResult result = workers.run(one);
        result.command = commandOf(arguments, one.name);
        if (const std::string text = stressText(result); !text.empty()) {
            progress.clear();
            say("{}", text);
        }
        results.push_back(std::move(result));
        write(arguments, info, results); // at once: what is stopped here goes on with --resume
    }
    progress.clear();
    write(arguments, info, results);
    say("{}\n", summary(results));
    if (!arguments.page.empty()) say("{}\n", (std::filesystem::path(arguments.page) / "index.html").string());
    const bool bad =
        std::ranges::any_of(results, [](const StressResult& result) { return isBad(result.outcome); });
    return static_cast<int>(bad ? ExitStatus::MeasureFailed : ExitStatus::Done);
}

} // namespace

void addStressCommand(CLI::App& app, Run& run) {
    CLI::App* command = app.add_subcommand("stress", "Run a graph through stiff and extreme cases");
    const auto arguments = std::make_shared<StressArguments>();
    arguments->size = "64x36";
    addGraphArguments(*command, *arguments);
    command->get_option("GRAPH")->required(false);
    command
        ->add_option("--only", arguments->only,
                     "Only this case, or the cases of this kind; of a curve only this variant")
        ->check(notEmpty());
    command->add_flag("--list", arguments->list, "Print the cases and what each does");
    command->add_option("--json", arguments->json, "Write the results as JSON, anew after each case")
        ->check(notEmpty());
    command->add_flag("--resume", arguments->resume, "Go on with what the file of --json holds");
    command
        ->add_option("--page", arguments->page,
                     "Folder for a page: cases by outputs, with pictures of what is missed")
        ->check(notEmpty());
    command->add_option("--timeout", arguments->timeout, "Seconds after which a case counts as hung")
        ->check(CLI::Range(0.01, 1e6))
        ->capture_default_str();
    command->add_flag("--keep-all", arguments->keepAll, "Leave nothing out in any case");
    command->add_flag("--limits", arguments->limits, "Print the limits of methods as Markdown");
    command->add_option("--backend", arguments->backend, "egl, osmesa or window")->capture_default_str();
    CLI::Option* drawn = command->add_option(
        "--curve", arguments->curve,
        "Draws how far each technique is off over decades of one number: scale, place, off_centre, "
        "far_over_near or layers. GRAPH may be a sweep file: its variants against its reference");
    drawn->check(notEmpty())->excludes(command->get_option("--resume"));
    command->add_option("--values", arguments->values, "Of a curve: the numbers, in place of its decades")
        ->delimiter(',')
        ->needs(drawn);
    command
        ->add_option("--frames", arguments->frames,
                     "Of a curve: after how many frames pictures are taken; default: the sweep's, else 16")
        ->check(CLI::Range(1, 100'000));
    // Hidden: how the command starts itself.
    command->add_flag("--worker", arguments->worker)->group("");
    command->add_option("--keep", arguments->keep)->group("");
    command->footer("In every case each value of each output of each pass must be finite and in its port's "
                    "range; scaled, moved "
                    "and turned scenes must give the plain picture, up to 1.25 times the distance of two "
                    "seeds. Each case runs in "
                    "a process that may crash or hang. Exit status 1 if a case is missed.\n\n"
                    "Examples:\n"
                    "  kestrel stress ray_ao.json --scene model.glb --page page\n"
                    "  kestrel stress ray_ao.json --only scale/1e+06\n"
                    "  kestrel stress my.json --json results.json --resume\n"
                    "  kestrel stress my_sweep.json --curve scale --page page");
    command->callback([arguments, command, &run] {
        run = [arguments, sizeGiven = command->count("--size") > 0] { return stress(*arguments, sizeGiven); };
    });
}

} // namespace kestrel
