// The module `tracer` by marching over the pixels of a depth buffer (McGuire and Mara, "Efficient GPU Screen-Space Ray
// Tracing", 2014). Directions are not replaced.
//
// The ray's projection is walked in equal steps along its longer screen axis; what is linear in space is interpolated
// with 1 / w. A sample hits if the ray is behind what its pixel shows, and since the last sample was no further behind
// than the thickness. A ray towards the eye is asked at the sample alone: the surface that it starts on comes nearer too,
// and would lie before where the ray was. Leaving the image, ending, or running out of STEPS is a miss.
//
// The pixel that a ray from a surface starts in does not count, and its origin moves off the surface by half the width of a
// pixel: depths of the pixel beside differ from those on the ray by up to half a pixel's slope.
#include "lib/frame.glsl"
#include "lib/tracer.glsl"
#include "lib/iterations.glsl"
#include "lib/view.glsl"
#include "shared/near_field.h"
#include "shared/random.h"

void M(aim)(inout Ray ray) {}

#ifdef EMPTY
#include <part:lib/no_hits.glsl>
#else

layout(std140) uniform M(DepthView) { ViewData M(depthView); };
layout(std140) uniform M(Settings) { ScreenTraceSettings M(settings); };
uniform sampler2D M(depth);

// Render-space width of a pixel at a distance along the viewing axis.
float M(pixelWidth)(float viewDistance) {
    float width = 2.0 * M(depthView).inverseProjection[1].y / float(M(depthView).size.y);
    return M(depthView).position.w != 0.0 ? width : width * viewDistance;
}

// Whether something is met in [tMin, tMax]; where, and how far the surface may lie from there.
bool M(march)(Ray ray, out float t, out float error) {
    t = 0.0;
    error = 0.0;
    vec3 start = (M(depthView).view * vec4(ray.origin, 1.0)).xyz;
    vec3 direction = mat3(M(depthView).view) * ray.direction;
    bool onSurface = ray.normal != vec3(0.0);
    float near = M(depthView).nearPlane;
    start += M(settings).offset * M(pixelWidth)(max(-start.z, near)) * (mat3(M(depthView).view) * ray.normal);

    // The part in front of the near plane and up to where the scene's sphere must end. Along it the distance in the
    // viewing axis is nearest + t * away.
    float nearest = -start.z;
    float away = -direction.z;
    float from = ray.tMin;
    float to = min(ray.tMax, distance(ray.origin, frame.sceneBounds.xyz) + frame.sceneBounds.w);
    if (away < 0.0) to = min(to, (near - nearest) / away);
    if (away > 0.0) from = max(from, (near - nearest) / away);
    if (!(from < to) || (away == 0.0 && nearest < near)) return false;

    vec4 first = M(depthView).projection * vec4(start + from * direction, 1.0);
    vec4 last = M(depthView).projection * vec4(start + to * direction, 1.0);
    float inverseW0 = 1.0 / first.w;
    float inverseW1 = 1.0 / last.w;
    vec2 size = vec2(M(depthView).size);
    vec2 begin = (first.xy * inverseW0 * 0.5 + 0.5) * size;
    vec2 way = (last.xy * inverseW1 * 0.5 + 0.5) * size - begin;
    float pixels = max(abs(way.x), abs(way.y));
    float inversePixels = 1.0 / max(pixels, 1e-6);

    float skipped = 1.0;
#ifdef JITTER
    uvec2 pixel = uvec2(clamp(begin, vec2(0.0), size - 1.0));
    skipped += (M(settings).stride - 1.0) *
               unitFloat(hashCombine(pixelSeed(pixel, randomScreenTrace, frame.seed), frame.index));
#endif
    // Of the inverse projection, what a depth needs to become a distance.
    vec2 column = M(depthView).inverseProjection[2].zw;
    vec2 constant = M(depthView).inverseProjection[3].zw;
    float before = from;
    bool found = false;
    for (int i = 0; i < STEPS; ++i) {
        ITERATION;
        float s = (skipped + float(i) * M(settings).stride) * inversePixels;
        // A ray within one pixel has its end for a sample; one from a surface has none, since that pixel is its own.
        if (i == 0 && !onSurface) s = min(s, 1.0);
        vec2 at = begin + s * way;
        if (s > 1.0 || any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, size))) break;
        t = from + (to - from) * s * inverseW1 / mix(inverseW0, inverseW1, s);
        float now = nearest + t * away;
        float depth = texelFetch(M(depth), ivec2(at), 0).x;
        vec2 eye = column * depth + constant;
        float shown = -eye.x / eye.y;
        float behind = M(settings).thickness * M(pixelWidth)(shown) * size.y;
        if (depth > 0.0 && now > shown && min(now, nearest + before * away) < shown + behind) {
            // Where the ray passes the depth of the pixel, if it does so here.
            if (abs(away) > 1e-6) t = clamp((shown - nearest) / away, before, t);
            error = max(M(settings).stride * M(pixelWidth)(shown), nearest + t * away - shown);
            found = true;
            break;
        }
        before = t;
    }
    return found;
}

bool M(anyHit)(Ray ray) {
    float t, error;
    return M(march)(ray, t, error);
}

bool M(closestHit)(Ray ray, out Hit hit) {
    hit = noHit;
    float t, error;
    if (!M(march)(ray, t, error)) return false;
    hit.t = clamp(t, ray.tMin, ray.tMax);
    hit.error = error;
    return true;
}

#endif // EMPTY
