// Many rays in one call: what a tracer may provide beside single queries, and a consumer whose rays are had
// by number may request (lib/tracer.glsl).
#pragma once
#include "graph/types.h"

namespace kestrel {

namespace provides {
inline constexpr Bits ManyRays = 1 << 4;    // any hits
inline constexpr Bits ManyClosest = 1 << 5; // closest hits
} // namespace provides
namespace requests {
inline constexpr Bits ManyRays = 1 << 5;    // requires provides::ManyRays; defines REQUESTS_MANY
inline constexpr Bits ManyClosest = 1 << 6; // requires provides::ManyClosest; defines REQUESTS_MANY_CLOSEST
} // namespace requests

} // namespace kestrel
