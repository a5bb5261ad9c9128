// Limits that a method itself has: how far its pictures may differ in which cases, with the reason. They
// stand in graphs/stress/limits.json and in the README's table. What is not finite or out of range, a hang or
// a crash is never a limit.
#pragma once
#include "measure/stress/stress_results.h"
#include <string>
#include <vector>

namespace kestrel {

struct StressLimit {
    std::string pass;   // type; the graph has one; empty: any graph
    std::string graph;  // name of its file without the ending; empty: any
    std::string cases;  // name of one, or of a kind
    std::string port;   // "pass.port"; empty: any
    double times = 1;   // as far as is allowed otherwise, at most
    std::string reason; // one sentence without full stop
};

// Those that come with Kestrel. Throws InputError with every mistake in the file.
[[nodiscard]] const std::vector<StressLimit>& stressLimits();
// Marks the checks that are missed by no more than a limit of the graph's passes allows.
void applyStressLimits(StressResult& result, const Graph& graph);
// The README's table.
[[nodiscard]] std::string stressLimitsMarkdown();

} // namespace kestrel
