// Stress cases in a process of their own, so that a crash or a hang of a pass or a driver costs one case. A
// worker makes one case after the other; one that crashed or hung is replaced.
#pragma once
#include "core/child_process.h"
#include "measure/stress/stress_run.h"
#include <memory>

namespace kestrel {

class StressWorkers {
public:
    // `command` starts a worker: a program that calls serveStressCases(). `timeout` is of one case, seconds.
    StressWorkers(std::vector<std::string> command, double timeout);

    // Starts a worker where there is none and returns its renderer. Throws an Error with the worker's own
    // status and message where it ends before it is ready.
    const std::string& renderer();
    // Throws as renderer() does.
    StressResult run(const StressCase& one);

private:
    void start();
    [[nodiscard]] std::string lastWords() const;

    std::vector<std::string> command_;
    double timeout_;
    std::string renderer_;
    std::unique_ptr<ChildProcess> child_;
};

// In a worker: makes the cases whose names come in until none comes any more. `makeRunner` is told what to do
// before each step. Returns the exit status.
using MakeStressRunner = std::function<StressRunner(std::function<void(const std::string& step)> begins)>;
int serveStressCases(const std::string& renderer, const MakeStressRunner& makeRunner);

} // namespace kestrel
