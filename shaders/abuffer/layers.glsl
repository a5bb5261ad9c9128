// The module `layers` of an A-buffer: the fragments of the frame's view at a pixel, nearest first. Asked for by number
// it has LAYERS of them; walked through, all.
#include "lib/frame.glsl"
#include "lib/layers.glsl"
#include "lib/iterations.glsl"
#include "abuffer/lists.glsl"

const int M(count) = LAYERS;

ivec2 M(texel)(vec2 uv) { return clamp(ivec2(floor(uv * vec2(frame.size))), ivec2(0), ivec2(frame.size) - 1); }

vec2 M(position)(ivec2 texel) { return (vec2(texel) + 0.5) / vec2(frame.size); }

#ifdef EMPTY
float M(depth)(ivec2 texel, int layer) { return noLayer; }
#ifdef REQUESTS_SURFACE
LayerSurface M(firstSurface)(ivec2 texel) { return noLayerSurface; }
void M(nextSurface)(ivec2 texel, inout LayerSurface at) { at = noLayerSurface; }
#endif
#else

layout(r32ui) uniform readonly uimageBuffer M(pixels);
layout(r32ui) uniform readonly uimageBuffer M(nodes);
#if defined(REQUESTS_SURFACE) && defined(DECOUPLED)
layout(r32ui) uniform readonly uimageBuffer M(data);
#endif

// A place in a list: its node, 0 behind the end, and what else takes it onwards: SB how many follow, with buckets which
// one.
uvec2 M(placeFrom)(ivec2 texel, uint bucket) {
    int words = ABUFFER_PIXEL(0u, texel) * PIXEL_WORDS;
#if defined(SB)
    uint count = imageLoad(M(pixels), words + 1).r;
    return count > 0u ? uvec2(imageLoad(M(pixels), words).r, count - 1u) : uvec2(0u);
#elif defined(BUCKETED)
    uint node = 0u;
    for (; bucket < uint(BUCKETS); ++bucket) {
        ITERATION;
        node = imageLoad(M(pixels), words + HEAD_WORD(bucket)).r;
        if (node != 0u) break;
    }
    return uvec2(node, bucket);
#else
    return uvec2(imageLoad(M(pixels), words + HEAD_WORD(0)).r, 0u);
#endif
}

uvec2 M(placeAfter)(ivec2 texel, uvec2 place) {
#if defined(SB)
    return place.y > 0u ? uvec2(place.x + 1u, place.y - 1u) : uvec2(0u);
#else
    uint node = imageLoad(M(nodes), NODE_AT(place.x, 1)).r;
#ifdef BUCKETED
    if (node == 0u) return M(placeFrom)(texel, place.y + 1u);
#endif
    return uvec2(node, place.y);
#endif
}

float M(depthAt)(uvec2 place) {
    return place.x != 0u ? uintBitsToFloat(imageLoad(M(nodes), NODE_AT(place.x, 0)).r) : noLayer;
}

// What was asked for last: samples of a texel in turn walk through its list once.
ivec2 M(lastTexel) = ivec2(-1);
int M(lastLayer) = 0;
uvec2 M(lastPlace) = uvec2(0u);

float M(depth)(ivec2 texel, int layer) {
    if (texel != M(lastTexel) || layer < M(lastLayer)) {
        M(lastTexel) = texel;
        M(lastLayer) = 0;
        M(lastPlace) = M(placeFrom)(texel, 0u);
    }
    while (M(lastLayer) < layer && M(lastPlace).x != 0u) {
        ITERATION;
        M(lastPlace) = M(placeAfter)(texel, M(lastPlace));
        ++M(lastLayer);
    }
    return M(depthAt)(M(lastPlace));
}

#ifdef REQUESTS_SURFACE
LayerSurface M(surfaceAt)(uvec2 place) {
    if (place.x == 0u) return noLayerSurface;
#if defined(DECOUPLED) && defined(SB)
    uint triangle = imageLoad(M(data), int(imageLoad(M(nodes), NODE_AT(place.x, 1)).r) - 1).r;
#elif defined(DECOUPLED)
    uint triangle = imageLoad(M(data), int(place.x) - 1).r;
#else
    uint triangle = imageLoad(M(nodes), NODE_AT(place.x, TRIANGLE_WORD)).r;
#endif
    return LayerSurface(M(depthAt)(place), triangle, place);
}

LayerSurface M(firstSurface)(ivec2 texel) { return M(surfaceAt)(M(placeFrom)(texel, 0u)); }

void M(nextSurface)(ivec2 texel, inout LayerSurface at) {
    at = M(surfaceAt)(M(placeAfter)(texel, at.token));
}
#endif

#endif // EMPTY
