// One axis of an exact Euclidean distance transform: the lower envelope of the parabolas that stand on a line's cells
// (Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled Functions", 2012; in whole cells as Meijster et al., "A
// General Algorithm for Computing Distance Transforms in Linear Time", 2000). One invocation a line.
//
// ALONG_Y: lines along y; the distance along z comes from the bits of the map's columns. Otherwise lines along x, from
// the squared distances `planes` that this left, and distances are written.
#include "distance_field/half.glsl"
#include "lib/iterations.glsl"
#include "shared/occupancy.h"

layout(local_size_x = 32, local_size_y = 2) in;

#ifdef ALONG_Y
#ifdef BASE_STORAGE
layout(std430) readonly buffer Occupancy { uint words[]; };
#define WORD(index) words[index]
#else
layout(r32ui) readonly uniform uimageBuffer occupancy;
#define WORD(index) imageLoad(occupancy, index).x
#endif
layout(r32f) writeonly uniform image3D planes;
#else
layout(r32f) readonly uniform image3D planes;
layout(r16f) writeonly uniform image3D field;
#endif

const float none = float(4 * RESOLUTION * RESOLUTION); // above any squared distance

// Squared distance of cell i of the line to the nearest occupied one across the axes that are done.
float across(ivec2 line, int i) {
#ifdef ALONG_Y
    int z = line.y;
    int below = -RESOLUTION * 2; // the nearest occupied cells of the column up to z and from z on
    int above = RESOLUTION * 3;
    for (int w = 0; w < RESOLUTION / 32; ++w) {
        uint word = WORD((w * RESOLUTION + i) * RESOLUTION + line.x);
        uint low = word & columnMask(0, z, w);
        uint high = word & columnMask(z, RESOLUTION - 1, w);
        below = low != 0u ? 32 * w + findMSB(low) : below;
        above = high != 0u ? min(above, 32 * w + findLSB(high)) : above;
    }
    float apart = float(min(z - below, above - z));
    return min(apart * apart, none);
#else
    return imageLoad(planes, ivec3(i, line)).x;
#endif
}

void main() {
    ivec2 line = ivec2(gl_GlobalInvocationID.xy);
    // The parabolas of the envelope: where they stand, how high, and the first cell in which each is the lowest.
    int stands[RESOLUTION];
    float heights[RESOLUTION];
    int top = -1;
    for (int i = 0; i < RESOLUTION; ++i) {
        ITERATION;
        float height = across(line, i);
        if (height >= none) continue;
        int begins = 0;
        while (top >= 0) {
            ITERATION;
            int entry = stands[top];
            int stand = entry & 0xffff;
            float last = heights[top];
            // The new parabola is lower than the top one from the cell after `meet` on.
            float meet = (float(i * i - stand * stand) + height - last) / float(2 * (i - stand));
            int from = int(clamp(floor(meet), -1.0, float(RESOLUTION))) + 1;
            begins = max(from, 0);
            if (from > entry >> 16) break;
            --top;
            begins = 0;
        }
        if (begins < RESOLUTION) {
            ++top;
            stands[top] = i | begins << 16;
            heights[top] = height;
        }
    }
    for (int i = RESOLUTION - 1; i >= 0; --i) {
        ITERATION;
        float least = none;
        if (top >= 0) {
            int entry = stands[top];
            float apart = float(i - (entry & 0xffff));
            least = apart * apart + heights[top];
            if (i == entry >> 16) --top;
        }
#ifdef ALONG_Y
        imageStore(planes, ivec3(line.x, i, line.y), vec4(least));
#else
        imageStore(field, ivec3(i, line), vec4(nearestHalf(sqrt(least))));
#endif
    }
    ITERATIONS_END;
}
