// The loop guard: on demand the iterations of shaders' loops are counted (shaders/lib/iterations.glsl).
//
// Some drivers give an invocation 65,535 iterations of all its loops together and then cut them short in
// silence; what they would have computed then lacks. So no invocation may make more than maxIterations, and
// shaders whose bounds depend on data count theirs when iterationsDefine is among the program's defines. The
// storage block is then bound, cleared to zero, under iterationsBlockName; after the frame, `exhausted` other
// than zero is an error.
#pragma once
#include <cstdint>

namespace kestrel {

// The most iterations that all loops of an invocation may make together.
inline constexpr std::uint32_t maxIterations = 65'000;

inline constexpr const char* iterationsDefine = "KESTREL_COUNT_ITERATIONS";
inline constexpr const char* iterationsBlockName = "Iterations";

// The contents of the storage block (std430).
struct IterationsBlock {
    std::uint32_t exhausted = 0; // how many invocations exceeded maxIterations
    std::uint32_t maximum = 0;   // the most iterations that one made
};
static_assert(sizeof(IterationsBlock) == 8);

} // namespace kestrel
