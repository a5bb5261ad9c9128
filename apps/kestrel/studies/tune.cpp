// `kestrel tune`: finds the best settings of a sweep's variants on some scenes, and judges them on others.
#include "commands.h"
#include "common.h"
#include "core/log.h"
#include "graph/value_text.h"
#include "measure/tune/tune_folder.h"
#include "measure/tune/tune_run.h"
#include "measure/tune/tune_space.h"
#include "studies/sweep_command.h"
#include <fmt/format.h>
#include <memory>

namespace kestrel {
namespace {

// What is free of each point, and where it begins.
void printFree(const Sweep& sweep, const std::vector<SweepPoint>& points, const SweepOptions& options,
               const Registry& registry, bool json) {
    std::string list;
    for (size_t i = 0; i < points.size(); ++i) {
        if (!options.shard.has(i) || !options.chosen[i]) continue;
        const TuneSpace space = tuneSpace(sweep, points[i], registry);
        std::string start;
        for (const std::string& setting : space.settings(space.start))
            start += (start.empty() ? "" : json ? ", " : " ") + (json ? jsonText(setting) : setting);
        if (json)
            list += fmt::format("{}  {{\"variant\": {}, \"start\": [{}]}}", list.empty() ? "" : ",\n",
                                jsonText(points[i].name), start);
        else
            fmt::print("{}: {}\n", points[i].name, start.empty() ? "nothing is free" : start);
    }
    if (json) fmt::print("[\n{}\n]\n", list);
}

void printFound(const SweepResults& results) {
    for (const TuneReport::Point& point : results.tuning->points) {
        const TuneOutcome& outcome = point.outcome;
        std::string found;
        for (size_t i = 0; i < outcome.set.size(); ++i)
            if (outcome.set[i] != outcome.start[i]) found += " " + outcome.set[i];
        say("{}: {:.4g} to {:.4g}{}\n", point.name, outcome.startError, outcome.error,
            found.empty() ? ", the default stands" : "," + found);
    }
    say("{} of {} defaults are within 5 % of their tuned error; tuning changed the ranks of {} of {} plots "
        "that "
        "were held out\n",
        results.tuning->within(0.05), results.tuning->points.size(), results.tuning->heldOutChanged(),
        results.tuning->heldOut());
}

int runTuneCommand(const SweepArguments& arguments) {
    Sweep sweep = openSweep(arguments);
    sweep.tuned = true;
    const Registry& registry = loadedRegistry();
    const std::vector<SweepPoint> points = expandSweep(sweep);
    SweepOptions options;
    options.chosen = choosePoints(points, arguments.only);
    if (!arguments.shard.empty()) options.shard = parseShard(arguments.shard);
    checkSweep(sweep, points, registry);
    checkTuning(sweep, points, registry);
    if (arguments.list) {
        printFree(sweep, points, options, registry, arguments.json);
        return static_cast<int>(ExitStatus::Done);
    }
    if (arguments.folder.empty()) throw InputError("--out is missing: the folder that the results go into");
    if (!arguments.merge.empty()) {
        mergeSweep(sweep, arguments);
    } else {
        checkSweepScenes(sweep);
        if (static_cast<size_t>(options.shard.count) > points.size())
            logInfo("{} shards, but only {} variants to share out: some have nothing to do",
                    options.shard.count, points.size());
        measureSweep(sweep, arguments, "tune", options,
                     [&](gl::Context& context, const SweepMachine& machine, const SweepFolder& folder,
                         const SweepOptions& shown) {
                         runTuning(sweep, points, registry, context, machine, folder, shown);
                     });
    }
    const SweepFolder folder(arguments.folder, sweep);
    const std::vector<SweepPoint> judged = judgedPoints(points, folder);
    SweepResults results = folder.gather(judged, sweepUnits(sweep, judged));
    results.tuning = tuneReport(sweep, points, folder, results.rows);
    const int status = finishSweep(sweep, folder, results, arguments.json);
    if (!arguments.json) printFound(results);
    return status;
}

} // namespace

void addTuneCommand(CLI::App& app, Run& run) {
    CLI::App* command =
        app.add_subcommand("tune", "Find the best settings of variants on some scenes, judge them on others");
    const auto arguments = std::make_shared<SweepArguments>();
    addSweepArguments(*command, *arguments, "I/N: tune and judge every N-th variant only, from the I-th");
    command->footer(
        "A sweep file with 'tune': {\"train\": [scenes], \"hold_out\": [scenes]}, and in variants\n"
        "'tune': {\"roma.offset\": [0.25, 2], \"horizons.slices\": [1, 2, 4]}: two numbers are a range,\n"
        "any other list is of choices. Each is narrowed in ten steps, in turn, to the least mean error over\n"
        "the scenes of 'train' in at most 1.05 times the default's time. Each finished measurement is kept\n"
        "at once: after any stop, --resume goes on.\n"
        "Examples:\n"
        "  kestrel tune graphs/sweeps/tuned_ao.json --out tuned\n"
        "  kestrel tune graphs/sweeps/tuned_ao.json --list\n"
        "  parallel kestrel tune FILE --shard {}/4 --out shard{} ::: 1 2 3 4\n"
        "  kestrel tune FILE --out tuned --merge shard1 shard2 shard3 shard4");
    command->callback([arguments, &run] { run = [arguments] { return runTuneCommand(*arguments); }; });
}

} // namespace kestrel
