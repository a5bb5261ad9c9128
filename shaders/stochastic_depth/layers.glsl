// The module `layers` of a stochastic depth map: an array of images that hold up to four depths a texel each, or with DEPTH_BITS
// one depth each as the bits of a float.
#include "lib/frame.glsl"
#include "lib/layers.glsl"
#include "stochastic_depth/map.glsl"

#ifdef DEPTH_BITS
layout(r32ui) uniform restrict readonly uimage2DArray M(depths);
#else
layout(DEPTHS_FORMAT) uniform restrict readonly image2DArray M(depths);
#endif
layout(std140) uniform M(DepthsView) { ViewData M(view); };

const int M(count) = LAYERS;

ivec2 M(texel)(vec2 uv) { return mapTexelAt(M(view), uv * vec2(frame.size)); }

vec2 M(position)(ivec2 texel) { return mapPlaceOf(M(view), texel, JITTER) / vec2(frame.size); }

float M(depth)(ivec2 texel, int layer) {
#ifdef DEPTH_BITS
    return min(uintBitsToFloat(imageLoad(M(depths), ivec3(texel, layer)).r), noLayer);
#else
    vec4 four = imageLoad(M(depths), ivec3(texel, layer / 4));
    vec2 two = (layer & 2) != 0 ? four.zw : four.xy;
    return (layer & 1) != 0 ? two.y : two.x;
#endif
}
