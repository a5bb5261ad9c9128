// The module `layers` of two arrays, nearest first: depths (reversed ones of the rasterizer, or with DEPTH_BITS along the view's
// axis as bits) and triangles.
#include "lib/frame.glsl"
#include "lib/layers.glsl"
#include "lib/view.glsl"

#ifdef DEPTH_BITS
layout(r32ui) uniform readonly uimage2DArray M(depths);
#else
layout(r32f) uniform readonly image2DArray M(peeled);
layout(std140) uniform M(PeeledView) { ViewData M(view); };
#endif
#ifdef REQUESTS_SURFACE
layout(r32ui) uniform readonly uimage2DArray M(triangles);
#endif

const int M(count) = LAYERS;

ivec2 M(texel)(vec2 uv) { return clamp(ivec2(floor(uv * vec2(frame.size))), ivec2(0), ivec2(frame.size) - 1); }

vec2 M(position)(ivec2 texel) { return (vec2(texel) + 0.5) / vec2(frame.size); }

float M(depth)(ivec2 texel, int layer) {
#ifdef DEPTH_BITS
    return min(uintBitsToFloat(imageLoad(M(depths), ivec3(texel, layer)).r), noLayer); // infinity: none
#else
    float z = imageLoad(M(peeled), ivec3(texel, layer)).r;
    return z > 0.0 ? viewDepth(M(view), z) : noLayer;
#endif
}

#ifdef REQUESTS_SURFACE
LayerSurface M(surfaceAt)(ivec2 texel, int layer) {
    if (layer >= M(count)) return noLayerSurface;
    return LayerSurface(M(depth)(texel, layer), imageLoad(M(triangles), ivec3(texel, layer)).r, uvec2(layer, 0u));
}

LayerSurface M(firstSurface)(ivec2 texel) { return M(surfaceAt)(texel, 0); }

void M(nextSurface)(ivec2 texel, inout LayerSurface at) { at = M(surfaceAt)(texel, int(at.token.x) + 1); }
#endif
