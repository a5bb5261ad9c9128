// Which pixels a frame samples. A mean of n paths of standard deviation s has the variance s^2 / n; of all ways to deal out a
// number of paths the one that leaves the least error on the whole gives each pixel a share in proportion to s (Neyman, "On
// the Two Different Aspects of the Representative Method", 1934). Three steps:
//
//   MEASURE  s of each pixel into `deviation`, and sums by group of 8 x 8 pixels
//   TOTAL    their sum, in a fixed order
//   (none)   lists the pixels that have fewer paths than their share of the `wanted` ones
#include "lib/iterations.glsl"
#include "shared/work_list.h"

layout(r32f) uniform image2D deviation;
layout(std430) buffer Sums { float sums[]; }; // the sum of all, then those of groups of 8 x 8 pixels

#ifdef TOTAL

layout(local_size_x = 64) in;

uniform uint groups;
shared float parts[64];

void main() {
    uint i = gl_LocalInvocationIndex;
    float sum = 0.0;
    for (uint group = i; group < groups; group += 64u) {
        ITERATION;
        sum += sums[1u + group];
    }
    ITERATIONS_END;
    parts[i] = sum;
    barrier();
    if (i == 0u) {
        float all = 0.0;
        for (uint k = 0u; k < 64u; ++k) all += parts[k];
        sums[0] = all;
    }
}

#else

layout(local_size_x = 8, local_size_y = 8) in;

layout(rgba32f) uniform readonly image2D result;

#ifdef MEASURE

layout(r32f) uniform readonly image2D squares;
shared float parts[64];

float sumOfParts(float part) {
    barrier();
    parts[gl_LocalInvocationIndex] = part;
    barrier();
    float sum = 0.0;
    for (uint k = 0u; k < 64u; ++k) sum += parts[k];
    return sum;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(result);
    bool inside = all(lessThan(pixel, size));
    // A few paths may all have missed what the next one finds, and a pixel that is judged by its own paths gets more of them
    // where they were bright, and a mean that is too low. So: half by the eight pixels about it, half by its group.
    float about = 0.0;
    float own = 0.0;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            ivec2 at = clamp(pixel + ivec2(x, y), ivec2(0), size - 1);
            float variance = imageLoad(squares, at).r / max(imageLoad(result, at).a - 1.0, 1.0);
            if (x == 0 && y == 0) own = variance;
            else about += variance / 8.0;
        }
    float count = sumOfParts(inside ? 1.0 : 0.0);
    float ofGroup = sumOfParts(inside ? own : 0.0) / count;
    float s = inside ? min(sqrt(0.5 * (about + ofGroup)), 1e15) : 0.0;
    if (inside) imageStore(deviation, pixel, vec4(s));
    float sum = sumOfParts(s);
    if (gl_LocalInvocationIndex == 0u) sums[1u + gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = sum;
}

#else

layout(std430) buffer Pixels {
    WorkListHeader header;
    uint items[];
} list;
uniform float wanted; // paths a pixel that the picture is to have after this frame; 0: every pixel is sampled

const float least = 0.25; // of the mean share, for every pixel: its deviation may be known badly
shared uint groupCount;
shared uint groupFirst;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(result);
    bool inside = all(lessThan(pixel, size));
    ivec2 at = min(pixel, size - 1);
    float mean = sums[0] / float(size.x * size.y);
    float share = mean > 0.0 ? max(imageLoad(deviation, at).r / mean, least) : 1.0;
    bool sampled = inside && (wanted == 0.0 || imageLoad(result, at).a < wanted * share);
    // One atomic a group: those of all groups meet.
    if (gl_LocalInvocationIndex == 0u) groupCount = 0u;
    barrier();
    uint place = sampled ? atomicAdd(groupCount, 1u) : 0u;
    barrier();
    if (gl_LocalInvocationIndex == 0u && groupCount > 0u) {
        groupFirst = atomicAdd(list.header.count, groupCount);
        atomicMax(list.header.groups.x, (groupFirst + groupCount + workListGroup - 1u) / workListGroup);
    }
    barrier();
    if (sampled) list.items[groupFirst + place] = packPixel(uint(pixel.x), uint(pixel.y));
}

#endif
#endif
