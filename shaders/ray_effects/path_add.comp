// One more path in the mean of each pixel: m += (s - m) / n, with n in alpha, and of the luminance the sum of squared
// differences from the mean (Welford, "Note on a Method for Calculating Corrected Sums of Squares and Products", 1962).
#include "shared/work_list.h"

layout(std430) readonly buffer Light { vec4 light[]; };
layout(rgba32f) uniform image2D result;
#ifdef INDIRECT
layout(rgba32f) uniform image2D indirect;
#endif
#ifdef SQUARES
layout(r32f) uniform image2D squares;
#endif
#ifdef LISTED
layout(local_size_x = 64) in;
layout(std430) readonly buffer Pixels {
    WorkListHeader header;
    uint items[];
} list;
#else
layout(local_size_x = 8, local_size_y = 8) in;
#endif
uniform uint restart; // 1: this path is the first

const float most = 1e30; // sums stay finite

void main() {
#ifdef LISTED
    uint slot = gl_GlobalInvocationID.x;
    if (slot >= list.header.count) return;
    ivec2 pixel = unpackPixel(list.items[slot]);
#else
    uint slot = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(result)))) return;
#endif
    vec3 rays = min(light[2u * slot + 1u].rgb, vec3(most));
    vec3 all = min(light[2u * slot].rgb + rays, vec3(most));
    vec4 before = restart == 0u ? imageLoad(result, pixel) : vec4(0.0);
    float count = before.a + 1.0;
    vec3 mean = before.rgb + (all - before.rgb) / count;
    imageStore(result, pixel, vec4(mean, count));
#ifdef INDIRECT
    vec3 ofRays = restart == 0u ? imageLoad(indirect, pixel).rgb : vec3(0.0);
    imageStore(indirect, pixel, vec4(ofRays + (rays - ofRays) / count, count));
#endif
#ifdef SQUARES
    const vec3 weights = vec3(0.2126, 0.7152, 0.0722);
    float sum = restart == 0u ? imageLoad(squares, pixel).r : 0.0;
    sum += dot(all - before.rgb, weights) * dot(all - mean, weights);
    imageStore(squares, pixel, vec4(clamp(sum, 0.0, most)));
#endif
}
