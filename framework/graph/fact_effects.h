// What each fact of a scene leaves out of each pass, found by asking: passes declare for a scene of which no
// fact holds, and for the same scene of which one does, and what they declare less is the effect.
#pragma once
#include "graph/graph.h"
#include "graph/pass.h"
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace kestrel {

// Of one fact (SceneFact::name) and one type of pass, at any setting of its switches, wherever it stands in
// the graphs: through its inputs too.
struct FactEffect {
    std::string fact, pass;
    bool nothingRuns = false;     // of several steps none is left
    bool once = false;            // its steps run for nothing any more that a timeline brings, and did before
    Causes causes = Causes::None; // for which they need not run any more
    std::set<std::string> steps;  // that are not there
    std::set<std::string> constants; // outputs that are one value everywhere, an input, or not made
    std::set<std::string> smaller;   // outputs of fewer bytes
    std::set<std::string> reads;     // ports that a step or a module reads no more
    std::set<std::string> defines;   // of programs and modules that are not there, or 0
    std::map<std::string, std::string> leftOut; // what the pass says of it: what -> why
    // Whether anything but its own words tells that less is made.
    [[nodiscard]] bool isLess() const {
        return nothingRuns || any(causes) || !steps.empty() || !constants.empty() || !smaller.empty() ||
               !reads.empty() || !defines.empty();
    }
};

// By fact as they stand in sceneFactList(), then by pass; pairs without an effect are left out. The graphs
// must be valid.
[[nodiscard]] std::vector<FactEffect> factEffects(const Registry& registry, std::span<const Graph> graphs);

// A table of two columns: facts, and what falls out of which passes. Facts of which the same falls out share
// a row; those of which nothing does are told, too.
[[nodiscard]] std::string factsMarkdown(const std::vector<FactEffect>& effects);
// {"facts":[{"fact","passes":[{"pass","nothing_runs","once","causes","steps","constants","smaller","reads","defines",
// "left_out":[{"what","why"}]}]}]}; keys are only ever added.
[[nodiscard]] std::string factsJson(const std::vector<FactEffect>& effects);
// For people, a line each.
[[nodiscard]] std::string factsText(const std::vector<FactEffect>& effects);

} // namespace kestrel
