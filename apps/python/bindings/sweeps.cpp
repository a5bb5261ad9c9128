// Sweeps: measuring into a folder, as `kestrel sweep` does.
#include "bindings.h"
#include "core/error.h"
#include "core/version.h"
#include "gl/timer.h"
#include "gpu.h"
#include "measure/sweep_run.h"
#include "named.h"
#include <fmt/format.h>
#include <optional>
#include <pybind11/stl.h>

namespace kestrel::python {
namespace {

// Ends a sweep between two measurements; no error of ours, so that nobody takes it for a variant's.
struct Stopped {};

void sweepInto(const std::string& file, const std::string& out, bool resume, const std::string& only,
               const std::optional<std::vector<int>>& size, std::optional<int> frames,
               const std::string& shard, bool allowOutside, py::object progress) {
    Callback callback(std::move(progress));
    std::optional<Extent> extent;
    if (size) extent = extentOf(*size);
    if (frames && (*frames < 1 || *frames > maxSweepFrames))
        throw InputError(fmt::format("frames: it must be 1 to {}, not {}", maxSweepFrames, *frames));
    try {
        Gpu::get().run([&](Gpu& gpu) {
            Sweep sweep = loadSweep(file);
            if (extent) sweep.size = *extent;
            if (frames) sweep.frames = *frames;
            sweep.sizeGiven = extent.has_value();
            sweep.framesGiven = frames.has_value();
            sweep.allowOutside = allowOutside;
            const Registry& registry = loadedRegistry();
            const std::vector<SweepPoint> points = expandSweep(sweep);
            const std::vector<SweepUnit> units = sweepUnits(sweep, points);
            SweepOptions options;
            options.chosen = choosePoints(points, only);
            if (!shard.empty()) options.shard = parseShard(shard);
            checkSweep(sweep, points, registry);
            checkSweepScenes(sweep);
            options.progress = [&](double fraction, const std::string& what) {
                if (!callback(fraction, what) || gpu.interrupted()) throw Stopped();
            };
            gl::Context& context = gpu.context();
            const std::string clock(gl::StepClock(context.capabilities()).name());
            SweepMachine machine = thisMachine(context.capabilities().renderer, context.driver(), clock);
            machine.version = version() + " " + configuration();
            const SweepFolder folder(out, sweep);
            folder.begin(resume, &machine);
            runSweep(sweep, points, units, registry, context, machine, folder, options);
            folder.writeResults(folder.gather(points, units));
        });
    } catch (const Stopped&) {
    }
    callback.rethrow();
}

} // namespace

void bindSweeps(py::module_& module) { module.def("sweep", &sweepInto); }

} // namespace kestrel::python
