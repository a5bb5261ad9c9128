// The module `layers` of one depth a pixel of an image.
#include "lib/frame.glsl"
#include "lib/layers.glsl"
#include "shared/view.h"

layout(r32f) uniform readonly image2D M(second_depth);
layout(std140) uniform M(SecondDepthView) { ViewData M(view); };

const int M(count) = 1;

ivec2 M(texel)(vec2 uv) {
    ivec2 texel = ivec2(floor(uv * vec2(frame.size) / float(M(view).divisor))) + int(M(view).guard);
    return clamp(texel, ivec2(0), ivec2(M(view).size) - 1);
}

vec2 M(position)(ivec2 texel) {
    return (vec2(texel - int(M(view).guard)) + 0.5) * float(M(view).divisor) / vec2(frame.size);
}

float M(depth)(ivec2 texel, int layer) {
    float depth = imageLoad(M(second_depth), texel).r;
    return depth > 0.0 ? depth : noLayer;
}
