// Runs the cases of a curve in processes that may crash, and holds their pictures against each other.
#pragma once
#include "measure/stress/curve.h"
#include "measure/sweep_file.h"
#include <filesystem>
#include <functional>

namespace kestrel {

struct CurveOptions {
    std::filesystem::path folder = {};    // graphs and pictures are kept in it
    std::vector<std::string> worker = {}; // starts a worker; what says which graph and scene is added
    std::vector<double> values = {};      // in place of the curve's own; may be empty
    std::vector<bool> chosen = {};        // of the sweep's points
    double timeout = 120;                 // seconds a case
    std::function<void(double share, const std::string& what)> progress = {};
    std::function<void(const CurveResults&)> finished = {}; // told after each series
};

// A sweep of one graph whose variants are its outputs, without a reference.
[[nodiscard]] Sweep sweepOfGraph(const Graph& graph, const Registry& registry, const std::string& scene,
                                 const Extent& size, int frames);

// The sweep's variants on its scenes, its reference as the truth. Pictures only; the sweep must be checked.
CurveResults runCurve(const StressCurve& curve, const Sweep& sweep, const Registry& registry,
                      const CurveOptions& options);

} // namespace kestrel
