#include "studies/sweep_command.h"
#include "core/log.h"
#include "core/progress.h"
#include "core/version.h"
#include "gl/context.h"
#include "gl/timer.h"
#include "named.h"
#include "say.h"
#include <fmt/format.h>

namespace kestrel {
namespace {

void printRows(const Sweep& sweep, const SweepResults& results) {
    for (const SweepRow& row : results.rows) {
        const std::string name = row.scene + ": " + row.point;
        if (!row.picture.failed.empty()) {
            say("{}: failed\n", name);
            continue;
        }
        const auto time = row.ms.find(sweep.plotTime);
        const auto error = errorOf(row, sweep.plotError);
        say("{}: {} {:.2f} ms, {} {:.4g}{}\n", name, sweep.plotTime,
            time == row.ms.end() ? 0.0 : time->second.median,
            row.ray                     ? "disagreement"
            : sweep.plotError == "ssim" ? "1-ssim"
                                        : sweep.plotError,
            error.value_or(0), row.pareto ? ", on the front" : "");
    }
}

} // namespace

Sweep openSweep(const SweepArguments& arguments) {
    if (arguments.file.empty()) throw InputError("FILE is missing: the sweep file");
    Sweep sweep = loadSweep(arguments.file);
    if (!arguments.size.empty()) {
        sweep.size = parseSize(arguments.size);
        sweep.sizeGiven = true;
    }
    if (arguments.frames > 0) {
        sweep.frames = arguments.frames;
        sweep.framesGiven = true;
    }
    sweep.allowOutside = arguments.allowOutside;
    return sweep;
}

void measureSweep(const Sweep& sweep, const SweepArguments& arguments, const char* what, SweepOptions options,
                  const MeasureSweep& measure) {
    const auto context = gl::Context::create({.backend = gl::backendFromName(arguments.backend)});
    const std::string clock(gl::StepClock(context->capabilities()).name());
    SweepMachine machine = thisMachine(context->capabilities().renderer, context->driver(), clock);
    machine.version = version() + " " + configuration();
    const SweepFolder folder(arguments.folder, sweep);
    folder.begin(arguments.resume, &machine);
    ProgressBar progress(what);
    options.progress = [&](double fraction, const std::string& detail) { progress.update(fraction, detail); };
    measure(*context, machine, folder, options);
    progress.clear();
}

void mergeSweep(const Sweep& sweep, const SweepArguments& arguments) {
    const SweepFolder folder(arguments.folder, sweep);
    folder.begin(false, nullptr);
    for (const std::string& other : arguments.merge) folder.merge(SweepFolder(other, sweep));
}

int finishSweep(const Sweep& sweep, const SweepFolder& folder, const SweepResults& results, bool json) {
    folder.writeResults(results);
    if (json)
        fmt::print("{}", resultsJson(sweep, results));
    else
        printRows(sweep, results);
    if (!results.missing.empty())
        logInfo("{} of the sweep's measurements are not in {} yet", results.missing.size(),
                folder.path().string());
    if (!json) say("{}\n", (folder.path() / "index.html").string());
    bool failed = false;
    for (const SweepRow& row : results.rows) {
        if (row.picture.failed.empty()) continue;
        logError("{}: {}: {}", row.scene, row.point, row.picture.failed);
        failed = true;
    }
    return static_cast<int>(failed ? ExitStatus::MeasureFailed : ExitStatus::Done);
}

} // namespace kestrel
