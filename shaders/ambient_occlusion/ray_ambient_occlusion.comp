// RAYS any-hit queries a pixel over the cosine-weighted hemisphere (ROMA paper, equation 1).
//
// A ray is sampled with density cosine / pi, so an unreplaced direction counts 1. A snapping tracer replaces the ray by
// the candidate of the stratum that it fell into, and says with `weight` how much that candidate counts: its cosine over
// the mean cosine of the stratum, 0 below the horizon. COSINE_RATIO forms sum(w V) / sum(w); the paper's estimator
// counts every candidate above the horizon alike. Both are ratios, so an open plane gives 1 exactly; the first is free
// of the correlation between cosine and visibility within a stratum (a bias of the second that grows with the stratum).
// What points below the face is occluded by it.
#include "lib/frame.glsl"
#include "lib/view.glsl"
#include "lib/sampling.glsl"
#include "shared/random.h"
#include "lib/face.glsl"
#include "lib/iterations.glsl"
#include "lib/tracer.glsl"
#ifdef PIXELS
Ray rays[PIXELS * RAYS];
Ray tracer_ray(uint i) { return rays[i]; }
#endif
#include <port:tracer>

layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D depth;
layout(rgba16f) uniform readonly image2D normal;
layout(r32f) uniform image2D visibility;
#ifdef WEIGHT
layout(r32f) uniform image2D weight;
#endif
layout(std140) uniform DepthView { ViewData depthView; };
uniform float maximumDistance; // 0: infinite

// What the rays of a pixel start from.
struct Point {
    bool background;
    vec3 origin;
    vec3 normal;
    vec4 face;
    uint seed;
};

Point pointAt(ivec2 pixel) {
    float z = texelFetch(depth, pixel, 0).r;
    vec4 stored = imageLoad(normal, pixel);
    vec3 n = stored.xyz;
    bool background = z == 0.0 || dot(n, n) == 0.0;
    n = background ? vec3(0.0, 0.0, 1.0) : normalize(n);
    vec3 origin = positionFromDepth(depthView, vec2(pixel) + 0.5, z);
    return Point(background, origin, n, faceAt(pixel, n, depthView, origin, stored.w),
                 pixelSeed(uvec2(pixel), randomRayDirection, frame.seed));
}

Ray rayFrom(Point point, uint i) {
    vec2 u = scrambledSobol(frame.index * uint(TOTAL_RAYS) + uint(FIRST_RAY) + i, point.seed);
    Ray ray = surfaceRay(point.origin, point.normal, cosineHemisphere(u, point.normal));
    if (maximumDistance > 0.0) ray.tMax = maximumDistance;
    return ray;
}

void give(ivec2 pixel, bool background, float open, float sum) {
#ifdef CONTINUES
    // Between steps the images hold sums.
    open += imageLoad(visibility, pixel).r;
#ifdef WEIGHT
    sum += imageLoad(weight, pixel).r;
#else
    sum += float(FIRST_RAY);
#endif
#endif
#ifdef ENDS
    // Where no candidate stood above the horizon nothing is known of this frame: weight 0.
    float share = sum > 0.0 ? open / sum : 1.0;
    imageStore(visibility, pixel, vec4(background ? 1.0 : share));
#ifdef WEIGHT
    imageStore(weight, pixel, vec4(background ? 1.0 : sum / float(TOTAL_RAYS)));
#endif
#else
    imageStore(visibility, pixel, vec4(open));
#ifdef WEIGHT
    imageStore(weight, pixel, vec4(sum));
#endif
#endif
}

// A ray as it will be traced, and what it counts. Whether it has to be traced.
bool aimedRay(Point point, uint i, out Ray ray) {
    ray = rayFrom(point, i);
    tracer_aim(ray);
#ifndef COSINE_RATIO
    ray.weight = ray.weight > 0.0 ? 1.0 : 0.0;
#endif
    bool leaves = leaveFace(ray, point.face);
    if (point.background || ray.weight == 0.0) ray.tMax = -1.0; // an empty interval: no tracer walks it
    return leaves;
}

#ifdef PIXELS

// The tracer takes many rays at once: those of so many pixels, one above the other.
ivec2 pixelOf(uint i) { return ivec2(gl_GlobalInvocationID.x, gl_GlobalInvocationID.y * uint(PIXELS) + i); }

void main() {
    ivec2 size = imageSize(visibility);
    uint wanted = 0u, inside = 0u;
    for (uint i = 0u; i < uint(PIXELS); ++i) {
        // What is fetched from beyond an image is nobody's promise.
        ivec2 pixel = pixelOf(i);
        Point point = pointAt(min(pixel, size - 1));
        point.background = point.background || any(greaterThanEqual(pixel, size));
        if (!point.background) inside |= 1u << i;
        for (uint j = 0u; j < uint(RAYS); ++j) {
            ITERATION;
            uint k = i * uint(RAYS) + j;
            if (aimedRay(point, j, rays[k]) && rays[k].tMax >= 0.0) wanted |= 1u << k;
        }
    }
    uint open = wanted & ~tracer_anyHits(wanted);
    for (uint i = 0u; i < uint(PIXELS); ++i) {
        float seen = 0.0, sum = 0.0;
        for (uint j = 0u; j < uint(RAYS); ++j) {
            ITERATION;
            uint k = i * uint(RAYS) + j;
            sum += rays[k].weight;
            if ((open >> k & 1u) != 0u) seen += rays[k].weight;
        }
        ivec2 pixel = pixelOf(i);
        if (all(lessThan(pixel, size))) give(pixel, (inside >> i & 1u) == 0u, seen, sum);
    }
    ITERATIONS_END;
}

#else

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(visibility)))) return;

    Point point = pointAt(pixel);
    float open = 0.0, sum = 0.0;
    for (uint i = 0u; i < uint(RAYS); ++i) {
        ITERATION;
        Ray ray;
        bool leaves = aimedRay(point, i, ray);
        bool met = tracer_anyHit(ray);
        if (leaves && !met) open += ray.weight;
        sum += ray.weight;
    }
    ITERATIONS_END;
    give(pixel, point.background, open, sum);
}

#endif
