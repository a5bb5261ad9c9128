// One ray a listed texel, or with WHOLE_MAP one a texel, behind the first surface; of its hits LAYERS depths stay.
//
// RESERVOIR is Listing 1 of the paper: slots fill in the order of the hits, then each further hit replaces a random one with
// falling probability, where nearer. COVERAGE_MASK keeps a hit in the slots of a random mask where it is the nearest
// (Vermeer, Scandolo, Eisemann 2021), K_BUFFER keeps the nearest hits. Accepting a hit shortens the ray to it.
#include "lib/view.glsl"
#include "lib/layers.glsl"
#include "lib/hits.glsl"
#include "lib/iterations.glsl"
#include "stochastic_depth/map.glsl"
#include "shared/work_list.h"
#include "lib/frame.glsl"

float kept[LAYERS]; // distances along the ray
uint counted = 0u;
uint seed = 0u;

bool hits_visit(inout Ray ray, Hit hit) {
    bool accept = false;
#ifdef RESERVOIR
    int slot = int(counted);
    ++counted;
    if (counted > uint(LAYERS)) slot = int(unitFloat(hashCombine(seed, counted)) * float(counted));
    for (int i = 0; i < LAYERS; ++i)
        if (i == slot && (!Z_CULL || hit.t < kept[i])) kept[i] = hit.t;
#endif
#ifdef COVERAGE_MASK
    ++counted;
    uint mask = coverageMask(uint(LAYERS), coverageAlpha(uint(LAYERS)), unitFloat(hashCombine(seed, 2u * counted)),
                             unitFloat(hashCombine(seed, 2u * counted + 1u)));
    float farthest = 0.0;
    for (int i = 0; i < LAYERS; ++i) {
        if ((mask >> i & 1u) != 0u) kept[i] = min(kept[i], hit.t);
        farthest = max(farthest, kept[i]);
    }
    accept = hit.t >= farthest;
#endif
#ifdef K_BUFFER
    if (hit.t < kept[LAYERS - 1]) ++counted;
    float sinking = hit.t;
    for (int i = 0; i < LAYERS; ++i) {
        float nearer = min(kept[i], sinking);
        sinking = max(kept[i], sinking);
        kept[i] = nearer;
    }
    ray.tMax = min(ray.tMax, kept[LAYERS - 1]);
#endif
#if MAX_COUNT > 0
    accept = accept || counted >= uint(MAX_COUNT);
#endif
    if (accept) ray.tMax = min(ray.tMax, hit.t);
    return false;
}
#include <port:hits>

#ifdef WHOLE_MAP
layout(local_size_x = 8, local_size_y = 8) in;
#else
layout(local_size_x = 64) in;
layout(std430) readonly buffer Texels {
    WorkListHeader header;
    uint items[];
} list;
#endif

layout(r32f) uniform readonly image2D view_depth;
#ifdef INTERVAL // texels per axis that share one
layout(r32ui) uniform readonly uimage2D ray_min;
layout(r32ui) uniform readonly uimage2D ray_max;
#endif
layout(DEPTHS_FORMAT) uniform writeonly image2DArray depths;
layout(std140) uniform ViewDepthView { ViewData depthView; };
layout(std140) uniform DepthsView { ViewData mapView; };

void main() {
#ifdef WHOLE_MAP
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(mapView.size)))) return;
#else
    if (gl_GlobalInvocationID.x >= list.header.count) return;
    ivec2 texel = unpackPixel(list.items[gl_GlobalInvocationID.x]);
#endif
    // The pixel of the depth whose ray this is; beyond the image nothing is known of the first surface.
    vec2 place = mapPlaceOf(mapView, texel, JITTER) / float(depthView.divisor) + float(depthView.guard);
    ivec2 pixel = ivec2(floor(place));
    bool inside = all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, ivec2(depthView.size)));
    float first = inside ? imageLoad(view_depth, pixel).r : 0.0;

    vec3 origin, direction;
    float tNear, tFar;
    cameraRay(depthView, vec2(pixel) + 0.5, origin, direction, tNear, tFar);
    float cosine = -dot(direction, depthView.inverseView[2].xyz);
    Ray ray = surfaceRay(origin, vec3(0.0), direction);
    ray.tMin = max(tNear, first * (1.0 + depthSeparation) / cosine);
    ray.tMax = tFar;
#ifdef INTERVAL
    ray.tMin = max(ray.tMin, uintBitsToFloat(imageLoad(ray_min, texel / INTERVAL).r));
    ray.tMax = min(ray.tMax, uintBitsToFloat(imageLoad(ray_max, texel / INTERVAL).r));
#endif
    // Where the first surface is not, nothing can be behind it.
    if (inside && first == 0.0) ray.tMax = -1.0;
    for (int i = 0; i < LAYERS; ++i) kept[i] = noLayer;
    seed = pixelSeed(uvec2(texel), randomStochasticDepth, frame.seed);
    hits_all(ray);
    ITERATIONS_END;
    for (int i = 0; i < LAYERS; ++i) kept[i] = kept[i] < noLayer ? kept[i] * cosine : noLayer;
    for (int i = 0; i < LAYERS; i += 4) {
        vec4 four = vec4(kept[i], kept[min(i + 1, LAYERS - 1)], kept[min(i + 2, LAYERS - 1)], kept[min(i + 3, LAYERS - 1)]);
        imageStore(depths, ivec3(texel, i / 4), four);
    }
}
