// `kestrel stress --curve`: one number of a case over decades, for the variants of a sweep or the outputs of
// a graph.
#pragma once
#include "common.h"

namespace kestrel {

struct CurveArguments {
    std::string curve = {}, only = {}, json = {}, page = {};
    std::vector<double> values = {};
    bool sizeGiven = false;
    int frames = 0;                       // 0: the sweep's; of a graph 16
    double timeout = 120;                 // seconds a picture
    std::vector<std::string> worker = {}; // starts a process that runs cases
};

// Returns the exit status. `arguments.graph` is a graph or a sweep file.
int drawCurve(const GraphArguments& arguments, const CurveArguments& curve);

} // namespace kestrel
