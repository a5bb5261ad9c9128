// The memory plan: which resources share one object.
#pragma once
#include "graph/plan.h"

namespace kestrel {

// Gives each resource of the plan its object and fills the memory report. Transient resources with equal
// descriptors and disjoint lifetimes share one (greedy colouring of intervals by their begin, which is
// optimal for each descriptor); the others get their own, a history two that follow each other.
void assignObjects(Plan& plan, bool shareMemory);

// Whether one object can serve both: everything but view and module bits is equal.
bool sameStorage(const Desc& a, const Desc& b);

} // namespace kestrel
