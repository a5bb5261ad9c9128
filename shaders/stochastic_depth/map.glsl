// Where the texels of a stochastic depth map lie, in pixels of the frame from its corner, y up.
#include "shared/stochastic_depth.h"
#include "shared/view.h"

ivec2 mapTexelAt(ViewData map, vec2 framePlace) {
    ivec2 texel = ivec2(floor(framePlace / float(map.divisor))) + int(map.guard);
    return clamp(texel, ivec2(0), ivec2(map.size) - 1);
}

// Of the map that has depthCellsAcross texels for each of this one's per axis.
ivec2 mapCellAt(ViewData map, vec2 framePlace) {
    ivec2 cell = ivec2(floor(framePlace * float(depthCellsAcross) / float(map.divisor)));
    return clamp(cell + depthCellsAcross * int(map.guard), ivec2(0), depthCellsAcross * ivec2(map.size) - 1);
}

// At the centre of a pixel of the frame, where the first surface is known.
vec2 mapPlaceOf(ViewData map, ivec2 texel, bool jitter) {
    ivec2 own = texel - int(map.guard);
    vec2 within = jitter ? sobolJitter(own) : vec2(0.5);
    return floor((vec2(own) + within) * float(map.divisor)) + 0.5;
}
