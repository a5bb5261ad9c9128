// For every sample of the mask, the part of the ray through its texel of the stochastic depth map in which something may
// occlude (section 3.2 of the stochastic depth map paper).
//
// A height over the point is met by the ray through a sample at a distance that the two share: the disc is square to the
// point's own ray. The texel's ray may pass up to a texel's diagonal beside the sample, which changes the distance by the
// sample's offset times the angle between them.
#include "ambient_occlusion/disc_images.glsl"
#include "stochastic_depth/map.glsl"
#include "shared/work_list.h"

layout(local_size_x = 64) in;

layout(MASK_FORMAT) uniform readonly uimage2D mask;
layout(std430) readonly buffer Pixels {
    WorkListHeader header;
    uint items[];
} list;
#ifdef SD_MASK
layout(r8ui) uniform writeonly uimage2D sd_mask;
#endif
#ifdef SD_CELLS
layout(r32ui) uniform uimage2D sd_cells;
#endif
#ifdef INTERVAL
layout(r32ui) uniform uimage2D ray_min;
layout(r32ui) uniform uimage2D ray_max;
#endif
layout(std140) uniform MAP_VIEW { ViewData mapView; };

void main() {
    if (gl_GlobalInvocationID.x >= list.header.count) return;
    ivec2 pixel = unpackPixel(list.items[gl_GlobalInvocationID.x]);
    EyeGrid grid = eyeGrid(depthView);
    float depth;
    DiscPoint point = pointAt(grid, pixel, depth);
    float texelAngle = 1.4142136 * float(mapView.divisor) * point.radius / (point.radiusPixels * float(depthView.divisor) * point.away);

    uint bits = imageLoad(mask, pixel).r;
    while (bits != 0u) {
        int i = findLSB(bits);
        bits &= bits - 1u;
        DiscSample s = discSample(grid, point, ivec2(depthView.size), kernel.disc[i]);
        vec2 framePlace = (s.place - float(depthView.guard)) * float(depthView.divisor);
        ivec2 texel = mapTexelAt(mapView, framePlace);
#ifdef SD_MASK
        imageStore(sd_mask, texel, uvec4(1u));
#endif
#ifdef SD_CELLS
        imageAtomicOr(sd_cells, texel, depthCellBit(mapCellAt(mapView, framePlace)));
#endif
#ifdef INTERVAL
        float height;
        bool hidden;
        firstContribution(grid, point, s, height, hidden);
        float top = s.outside < 0.0 ? min(height, reachOf(s)) : reachOf(s);
        float stretch = grid.parallel ? 1.0 : length(s.position) / point.away;
        float slack = grid.parallel ? 0.0 : length(kernel.disc[i].xy) * point.radius * texelAngle;
        float from = max((point.away - top * point.radius) * stretch - slack, 0.0);
        float to = max((point.away - s.back * point.radius) * stretch + slack, 0.0);
        // Of positive numbers the bits are ordered as the numbers are.
        imageAtomicMin(ray_min, texel, floatBitsToUint(from));
        imageAtomicMax(ray_max, texel, floatBitsToUint(to));
#endif
    }
}
