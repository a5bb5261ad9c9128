// The module `tracer` made of two: `near` up to `reach` along the ray, `far` beyond (ROMA, section 8). The far tracer aims,
// so it may snap; the near one traces the direction that came of it.
//
// The lowest bit of a hit's source says who answered, 1 far; the bits above are the answering tracer's own.
#include "lib/tracer.glsl"
#include "lib/iterations.glsl"
#include "shared/near_field.h"
#ifdef REQUESTS_MANY
Ray M(nearPart)(Ray ray);
Ray M(near_ray)(uint i) { return M(nearPart)(M(ray)(i)); }
#endif
#include <port:near>
#include <port:far>

layout(std140) uniform M(Settings) { NearFarSettings M(settings); };

void M(aim)(inout Ray ray) { M(far_aim)(ray); }

Ray M(nearPart)(Ray ray) {
    M(near_aim)(ray); // not snapping, it sets nothing but the token, which holds the far tracer's
    ray.tMax = min(ray.tMax, M(settings).reach);
    return ray;
}

// What has been answered ends at once: leaving a loop saves work where a branch does not.
Ray M(farPart)(Ray ray, bool answered) {
    ray.tMin = max(ray.tMin, M(settings).reach);
    ray.tMax = answered ? -1.0 : ray.tMax;
    return ray;
}

bool M(anyHit)(Ray ray) {
    bool answered = M(near_anyHit)(M(nearPart)(ray));
    return M(far_anyHit)(M(farPart)(ray, answered)) || answered;
}

#ifdef REQUESTS_MANY
// The far half first: it is the cheaper one where a near half pays, and what it has met needs no exact answer.
uint M(anyHits)(uint wanted) {
    uint hits = 0u;
    for (uint i = 0u; i < 32u && wanted >> i != 0u; ++i) {
        ITERATION;
        bool asked = (wanted >> i & 1u) != 0u;
        if (M(far_anyHit)(M(farPart)(M(ray)(i), !asked))) hits |= 1u << i;
    }
    return hits | M(near_anyHits)(wanted & ~hits);
}
#endif

#if defined(REQUESTS_CLOSEST) || defined(REQUESTS_SURFACE)
bool M(closestHit)(Ray ray, out Hit hit) {
    Hit beyond;
    bool answered = M(near_closestHit)(M(nearPart)(ray), hit);
    bool found = M(far_closestHit)(M(farPart)(ray, answered), beyond);
    hit.source = 2u * hit.source;
    beyond.source = 2u * beyond.source + 1u;
    if (!answered) hit = beyond;
    if (!answered && !found) hit = noHit;
    return answered || found;
}
#endif

#ifdef REQUESTS_SURFACE
Surface M(surface)(Ray ray, Hit hit) {
    bool isFar = (hit.source & 1u) != 0u;
    hit.source >>= 1u;
    if (isFar) return M(far_surface)(ray, hit);
    M(near_aim)(ray);
    return M(near_surface)(ray, hit);
}
#endif
