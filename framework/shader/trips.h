// The loop guard: a debug build counts the trips of loop nests in shaders (shaders/lib/trips.glsl).
//
// Some drivers stop a loop nest silently after 65,535 trips; what it would have computed then lacks. So no
// nest may make more than maxTrips, and shaders whose bounds depend on data count theirs when tripsDefine is
// among the program's defines. The storage block is then bound, cleared to zero, under tripsBlockName; after
// the frame, `exhausted` other than zero is an error.
#pragma once
#include <cstdint>

namespace kestrel {

// The most trips that an outermost loop with all loops inside it may make in one invocation.
inline constexpr std::uint32_t maxTrips = 65'000;

inline constexpr const char* tripsDefine = "KESTREL_DEBUG_TRIPS";
inline constexpr const char* tripsBlockName = "Trips";

// The contents of the storage block (std430).
struct TripsBlock {
    std::uint32_t exhausted = 0; // how many nests exceeded maxTrips, over all invocations
    std::uint32_t maximum = 0;   // the most trips that a nest made
};
static_assert(sizeof(TripsBlock) == 8);

} // namespace kestrel
