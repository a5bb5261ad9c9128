// The facts by which passes leave something out, one by one: for the compiler (`--keep-all` promises none of
// them) and for the table of what each of them saves (graph/fact_effects.h).
#pragma once
#include "scene/facts.h"
#include <string_view>
#include <vector>

namespace kestrel {

struct SceneFact {
    std::string_view name;     // "no triangle"
    void (*hold)(SceneFacts&); // makes it hold, with what follows from it
    bool moves = false;        // it says that something is at rest
};
[[nodiscard]] const std::vector<SceneFact>& sceneFactList();

// Of a scene that has everything, moves, and has two lights of each kind: none of those facts holds.
[[nodiscard]] SceneFacts richFacts();

// The same scene of which nothing may be promised but its counts and bounds.
[[nodiscard]] SceneFacts withoutPromises(SceneFacts facts);

} // namespace kestrel
