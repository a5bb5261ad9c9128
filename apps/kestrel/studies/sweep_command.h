// What `sweep` and `tune` share: the options of a sweep, the machine, and what is told at the end.
#pragma once
#include "measure/sweep_run.h"
#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace kestrel {

struct SweepArguments {
    std::string file, folder, shard, only, size, markdown, backend = "egl";
    std::vector<std::string> merge;
    int frames = 0;
    bool resume = false, list = false, json = false, schema = false, allowOutside = false;
};

// Those that both have; `shards` says what is shared out.
void addSweepArguments(CLI::App& command, SweepArguments& arguments, const std::string& shards);

// Throws InputError as loadSweep() does, and where no file is named.
Sweep openSweep(const SweepArguments& arguments);

// Opens the context, makes the folder ready, shows progress, and calls `measure`.
using MeasureSweep =
    std::function<void(gl::Context&, const SweepMachine&, const SweepFolder&, SweepOptions&)>;
void measureSweep(const Sweep& sweep, const SweepArguments& arguments, const char* what, SweepOptions options,
                  const MeasureSweep& measure);

// Joins the folders of shards into that of the results. Throws InputError.
void mergeSweep(const Sweep& sweep, const SweepArguments& arguments);

// Writes results and page and tells them; 1 if a variant failed.
int finishSweep(const Sweep& sweep, const SweepFolder& folder, const SweepResults& results, bool json);

} // namespace kestrel
