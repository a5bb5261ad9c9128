// The commands. Each adds itself to the command line; `run` is set to what it does when it is the one that
// was given.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>

namespace kestrel {

using Run = std::function<int()>;

void addRenderCommand(CLI::App& app, Run& run);
void addCheckCommand(CLI::App& app, Run& run);
void addPassesCommand(CLI::App& app, Run& run);
void addDotCommand(CLI::App& app, Run& run);
void addCompareCommand(CLI::App& app, Run& run);
void addSceneCommand(CLI::App& app, Run& run);
void addSweepCommand(CLI::App& app, Run& run);
void addTuneCommand(CLI::App& app, Run& run);
void addStressCommand(CLI::App& app, Run& run);

} // namespace kestrel
