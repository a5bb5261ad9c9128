// `kestrel sweep`: error against run time of many variants, into a folder with JSON, CSV and a page.
#include "commands.h"
#include "common.h"
#include "core/files.h"
#include "core/log.h"
#include "measure/sweep_schema.h"
#include "studies/sweep_command.h"
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

namespace kestrel {

namespace {

// What would be measured, and by which shard.
void printList(const Sweep& sweep, const std::vector<SweepPoint>& points, const std::vector<SweepUnit>& units,
               const SweepOptions& options, bool json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (size_t i = 0; i < units.size(); ++i) {
        if (!options.shard.has(i)) continue;
        const SweepScene& scene = sweep.scenes[static_cast<size_t>(units[i].scene)];
        for (const int index : units[i].points) {
            const SweepPoint& point = points[static_cast<size_t>(index)];
            if (!options.chosen[static_cast<size_t>(index)]) continue;
            list.push_back({{"scene", scene.name},
                            {"variant", point.name},
                            {"plot", point.plot},
                            {"unit", i + 1},
                            {"command", renderCommand(sweep, scene, point)}});
            if (!json)
                fmt::print("{}{}: {}\n", scene.name, point.plot.empty() ? "" : " (" + point.plot + ")",
                           point.name);
        }
    }
    if (json)
        fmt::print("{}\n", list.dump(2));
    else
        fmt::print(
            "{} measurements in {} of {} plots\n", list.size(),
            [&] {
                size_t own = 0;
                for (size_t i = 0; i < units.size(); ++i) own += options.shard.has(i) ? 1 : 0;
                return own;
            }(),
            units.size());
}

int runSweepCommand(const SweepArguments& arguments) {
    if (arguments.schema) {
        fmt::print("{}", sweepSchema());
        return static_cast<int>(ExitStatus::Done);
    }
    if (!arguments.markdown.empty()) {
        fmt::print("{}", resultsMarkdown(readText(arguments.markdown), arguments.markdown));
        return static_cast<int>(ExitStatus::Done);
    }
    const Sweep sweep = openSweep(arguments);
    const Registry& registry = loadedRegistry();
    const std::vector<SweepPoint> points = expandSweep(sweep);
    const std::vector<SweepUnit> units = sweepUnits(sweep, points);
    SweepOptions options;
    options.chosen = choosePoints(points, arguments.only);
    if (!arguments.shard.empty()) options.shard = parseShard(arguments.shard);
    checkSweep(sweep, points, registry);
    if (arguments.list) {
        printList(sweep, points, units, options, arguments.json);
        return static_cast<int>(ExitStatus::Done);
    }
    if (arguments.folder.empty()) throw InputError("--out is missing: the folder that the results go into");
    if (!arguments.merge.empty()) {
        mergeSweep(sweep, arguments);
    } else {
        checkSweepScenes(sweep);
        if (static_cast<size_t>(options.shard.count) > units.size())
            logInfo("{} shards, but only {} plots to share out: some have nothing to do", options.shard.count,
                    units.size());
        measureSweep(sweep, arguments, "sweep", options,
                     [&](gl::Context& context, const SweepMachine& machine, const SweepFolder& folder,
                         const SweepOptions& shown) {
                         runSweep(sweep, points, units, registry, context, machine, folder, shown);
                     });
    }
    const SweepFolder folder(arguments.folder, sweep);
    return finishSweep(sweep, folder, folder.gather(points, units), arguments.json);
}

} // namespace

void addSweepArguments(CLI::App& command, SweepArguments& arguments, const std::string& shards) {
    command.add_option("FILE", arguments.file,
                       "Sweep file (.json): scenes, the reference, variants; - is standard input");
    command
        .add_option("--out,-o", arguments.folder,
                    "Folder for results.json, results.csv, results.md, index.html")
        ->check(notEmpty());
    command.add_flag("--resume", arguments.resume,
                     "Go on with what the folder holds; what the sweep has gained since joins it");
    command.add_option("--shard", arguments.shard, shards);
    command
        .add_option("--merge", arguments.merge, "Join the folders of shards into --out, and measure nothing")
        ->expected(1, 100000);
    command.add_option("--only", arguments.only,
                       "Measure only this variant, or this series, or this one point");
    command.add_flag("--list", arguments.list, "Print what would be measured");
    command.add_option("--size", arguments.size, "Size of the frame instead of the file's, WIDTHxHEIGHT");
    command.add_option("--frames,-n", arguments.frames, "Frames before the picture instead of the file's")
        ->check(CLI::Range(1, 100'000));
    command.add_flag("--json", arguments.json, "Print the results as JSON");
    addAllowOutside(command, arguments.allowOutside);
    command.add_option("--backend", arguments.backend, "egl, osmesa or window")->capture_default_str();
}

void addSweepCommand(CLI::App& app, Run& run) {
    CLI::App* command = app.add_subcommand("sweep", "Measure error against run time of many variants");
    const auto arguments = std::make_shared<SweepArguments>();
    addSweepArguments(
        *command, *arguments,
        "I/N: measure every N-th plot only, from the I-th; a plot is a scene with all its variants, "
        "so that times that are compared come from one machine");
    command->add_flag("--schema", arguments->schema, "Print the JSON schema of sweep files");
    command->add_option("--markdown", arguments->markdown,
                        "Print the tables of this results.json as Markdown, and measure nothing");
    command->footer("Each finished measurement is kept at once: after any stop, --resume goes on.\n"
                    "Examples:\n"
                    "  kestrel sweep graphs/sweeps/ambient_occlusion.json --out results\n"
                    "  kestrel sweep graphs/sweeps/snap.json --out results --resume\n"
                    "  parallel kestrel sweep FILE --shard {}/4 --out shard{} ::: 1 2 3 4\n"
                    "  kestrel sweep FILE --out results --merge shard1 shard2 shard3 shard4\n"
                    "  kestrel sweep --markdown results/results.json\n"
                    "  kestrel sweep --schema > graphs/sweeps/schema.json");
    command->callback([arguments, &run] { run = [arguments] { return runSweepCommand(*arguments); }; });
}

} // namespace kestrel
