// In place of studies/ where KESTREL_STUDIES is off: its commands say where they are to be had.
#include "commands.h"
#include "core/error.h"

namespace kestrel {

namespace {

void addAbsentCommand(CLI::App& app, Run& run, const std::string& name, const std::string& description) {
    CLI::App* command = app.add_subcommand(name, description + " (not built here)");
    command->allow_extras()->fallthrough(false); // whatever is said to it
    command->callback([&run, name] {
        run = [name]() -> int {
            throw MachineError("'" + name + "' is not built here; apps/build.sh builds it");
        };
    });
}

} // namespace

void addSweepCommand(CLI::App& app, Run& run) {
    addAbsentCommand(app, run, "sweep", "Measure error against run time of many variants");
}

void addTuneCommand(CLI::App& app, Run& run) {
    addAbsentCommand(app, run, "tune",
                     "Find the best settings of variants on some scenes, judge them on others");
}

void addStressCommand(CLI::App& app, Run& run) {
    addAbsentCommand(app, run, "stress", "Run a graph through stiff and extreme cases");
}

} // namespace kestrel
