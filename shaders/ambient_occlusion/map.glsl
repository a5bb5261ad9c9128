// The texel of a stochastic depth map that answers for a pixel coordinate of a depth image of the same frame.
#include "shared/view.h"

ivec2 mapTexel(ViewData map, ViewData depth, vec2 place) {
    vec2 framePlace = (place - float(depth.guard)) * float(depth.divisor);
    ivec2 texel = ivec2(floor(framePlace / float(map.divisor))) + int(map.guard);
    return clamp(texel, ivec2(0), ivec2(map.size) - 1);
}
