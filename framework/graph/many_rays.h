// Any hits of many rays in one call: what a tracer may provide beside single queries, and a consumer whose
// rays are had by number may request (lib/tracer.glsl).
#pragma once
#include "graph/types.h"

namespace kestrel {

namespace provides {
inline constexpr Bits ManyRays = 1 << 4;
} // namespace provides
namespace requests {
inline constexpr Bits ManyRays = 1 << 5; // requires provides::ManyRays; defines REQUESTS_MANY
} // namespace requests

} // namespace kestrel
