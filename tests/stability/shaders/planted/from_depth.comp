// What the wrong passes make of the viewing depth.
#include "shared/view.h"
layout(local_size_x = 8, local_size_y = 8) in;

layout(r32f) uniform readonly image2D view_depth;
layout(r32f) uniform writeonly image2D result;
layout(std140) uniform ResultView { ViewData resultView; };

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(result);
    if (any(greaterThanEqual(pixel, size))) return;
    float depth = imageLoad(view_depth, pixel).r;
#if defined(DIVIDES_BY_FAR)
    float value = (depth + resultView.nearPlane) / resultView.farPlane;
#elif defined(FIXED_EPSILON)
    float beside = imageLoad(view_depth, min(pixel + ivec2(1, 0), size - 1)).r;
    float value = abs(beside - depth) < 0.05 ? 1.0 : 0.25;
#else
    float value = depth > 0.0 ? 1.0 : 0.5;
#endif
    imageStore(result, pixel, vec4(value));
}
