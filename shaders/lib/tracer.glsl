// The module interface `tracer`: what a consumer calls, whoever answers. A provider defines, wrapped in M():
//
//     void M(aim)(inout Ray ray)                  fixes the direction that will really be traced, and says so
//     bool M(anyHit)(Ray ray)                     is anything between tMin and tMax?
//     bool M(closestHit)(Ray ray, out Hit hit)    the nearest of it             (if REQUESTS_CLOSEST or REQUESTS_SURFACE)
//     Surface M(surface)(Ray ray, Hit hit)        evaluates a hit               (if REQUESTS_SURFACE)
//
// and, if it provides that (provides::ManyRays or ManyClosest of graph/many_rays.h), in place of the queries
//
//     uint M(anyHits)(uint wanted)                which of up to 32 rays meet anything, a bit each (if REQUESTS_MANY)
//     void M(closestHits)(uint wanted)            the nearest of each              (if REQUESTS_MANY_CLOSEST)
//
// which has each ray of `wanted`, aimed, from the consumer's Ray M(ray)(uint i), defined under its port's name (`tracer_ray`)
// before it includes the module. It may ask for one several times. What is nearest it gives to the consumer's
// void M(give)(uint i, bool met, Hit hit), once for each ray of `wanted`, in any order.
//
// A consumer fills a Ray, calls aim once, then traces. Everything is in render space.
#include "lib/surface.glsl"

// A macro: glslang takes no function call for the initialiser of a constant.
#define rayInfinity uintBitsToFloat(0x7f800000u)

struct Ray {
    vec3 origin;    // on a surface: off the face by as far as its place is uncertain; each tracer adds its own measure
    // Unit, on the side the ray leaves to; zero if there is no surface. For aim the axis of the cosine that the direction was
    // drawn with; for the queries the normal of the face, along which tracers move the origin (lib/face.glsl).
    vec3 normal;
    vec3 direction; // unit; aim may replace it by a nearby one where the consumer bears snapping (REQUESTS_SNAP)
    float tMin;
    float tMax;     // rayInfinity: unbounded
    // Multiplied by aim: the cosine at `normal` of the direction really traced over the mean cosine of what could have
    // been chosen in its place, 0 for a direction below the horizon (do not trace it). 1 if nothing was replaced.
    float weight;
    uint token;     // the tracer's own, from aim to the queries
};

struct Hit {
    float t;     // along the ray that was traced
    float error; // how far from there the surface may lie: 0 of triangles, about a cell of a proxy
    uint source; // which part of a composite tracer answered
    uvec2 id;    // opaque
};

#define noHit Hit(rayInfinity, 0.0, 0u, uvec2(0u))

Ray surfaceRay(vec3 origin, vec3 normal, vec3 direction) {
    return Ray(origin, normal, direction, 0.0, rayInfinity, 1.0, 0u);
}

// All that a hit of a tracer tells that gives positions only: a surface that faces the ray.
Surface facingSurface(Ray ray, Hit hit) {
    return Surface(ray.origin + hit.t * ray.direction, hit.error, -ray.direction, -ray.direction, vec3(0.0), 0.0, 1.0, vec3(0.0),
                   0u, true, 0.0);
}
