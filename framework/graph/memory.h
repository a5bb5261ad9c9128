// The memory plan: which resources share one object.
#pragma once
#include "graph/plan.h"

namespace kestrel {

// Gives each resource of the plan its object and fills the memory report.
// - Transient textures of equal descriptors and disjoint lifetimes share one object (greedy colouring of
//   intervals by their begin, which is optimal for each descriptor).
// - Transient buffers of any size lie in ranges of one object, where disjoint lifetimes may overlap. Without
//   a gain each has an object of its own or shares one of its size, and so do buffers smaller than
//   rangeAlignment.
// - The others get their own, a history two that follow each other.
void assignObjects(Plan& plan, bool shareMemory);

// Whether one object can serve both: everything but view and module bits is equal.
bool sameStorage(const Desc& a, const Desc& b);

// Bytes. The largest alignment that OpenGL 4.6 lets a device ask of a bound range of a buffer, be it a
// storage block, a uniform block or a texture buffer.
inline constexpr std::uint64_t rangeAlignment = 256;

// Something that needs bytes from step `first` to step `last`, both included.
struct Lifetime {
    int first = 0, last = 0;
    std::uint64_t bytes = 0;
};

// The most bytes that live in one step: no packing needs less.
std::uint64_t peakBytes(const std::vector<Lifetime>& lifetimes);

struct Packing {
    std::vector<std::uint64_t> offsets; // one each, multiples of rangeAlignment
    std::uint64_t bytes = 0;            // in all
};

// Places everything so that what lives in the same step does not overlap. To need the fewest bytes is NP-hard
// (dynamic storage allocation: Garey and Johnson 1979, SR2), so this takes the best of greedy placements that
// differ in their order (largest first, longest first, by begin) and in the gap they take (lowest, tightest).
// Time quadratic in the number of lifetimes, which is some tens.
Packing packLifetimes(const std::vector<Lifetime>& lifetimes);

} // namespace kestrel
