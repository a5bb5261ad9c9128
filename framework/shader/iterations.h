// The loop guard: on demand the iterations of loop nests in shaders are counted
// (shaders/lib/iterations.glsl).
//
// Some drivers stop a loop nest silently after 65,535 iterations; what it would have computed then lacks. So
// no nest may make more than maxIterations, and shaders whose bounds depend on data count theirs when
// iterationsDefine is among the program's defines. The storage block is then bound, cleared to zero, under
// iterationsBlockName; after the frame, `exhausted` other than zero is an error.
#pragma once
#include <cstdint>

namespace kestrel {

// The most iterations that an outermost loop with all loops inside it may make in one invocation.
inline constexpr std::uint32_t maxIterations = 65'000;

inline constexpr const char* iterationsDefine = "KESTREL_COUNT_ITERATIONS";
inline constexpr const char* iterationsBlockName = "Iterations";

// The contents of the storage block (std430).
struct IterationsBlock {
    std::uint32_t exhausted = 0; // how many nests exceeded maxIterations, over all invocations
    std::uint32_t maximum = 0;   // the most iterations that a nest made
};
static_assert(sizeof(IterationsBlock) == 8);

} // namespace kestrel
