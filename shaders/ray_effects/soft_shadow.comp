// RAYS shadow rays a pixel, each towards one point of one emitter. What a ray brings is the irradiance over pi of that point
// over the probability of its choice.
#include "lib/frame.glsl"
#include "lib/view.glsl"
#include "lib/sampling.glsl"
#include "shared/random.h"
#include "shared/emitter.h"
#include "lib/face.glsl"
#include "lib/iterations.glsl"
#include <port:tracer>

layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D depth;
uniform sampler2D normal;
layout(rgba32f) uniform readonly imageBuffer emitters;
layout(rgba32f) uniform image2D result;
#ifdef VISIBILITY
layout(r32f) uniform writeonly image2D visibility;
#endif
#ifdef WEIGHT
layout(r32f) uniform writeonly image2D weight;
#endif
layout(std140) uniform DepthView { ViewData depthView; };
uniform uint emitterCount;

// A ray ends this share of the way before the light, or it would meet the mesh that shows it; more than the start off the
// surface can shift it.
const float shortOfTheLight = 0.99609375; // 1 - 2^-8

float emitterUpper(uint index) { return imageLoad(emitters, int(emitterRecordTexels * index + 1u)).w; }

// The first emitter whose upper bound is above x.
uint chooseEmitter(float x) {
    uint low = 0u;
    uint high = max(emitterCount, 1u) - 1u;
    while (low < high) {
        ITERATION;
        uint middle = (low + high) / 2u;
        if (emitterUpper(middle) > x) {
            high = middle;
        } else {
            low = middle + 1u;
        }
    }
    return low;
}

struct LightSample {
    vec3 direction;
    float distance;
    float facing; // cosine at the emitter
    vec3 light;
};

#ifdef FLAT_EMITTERS
LightSample sampleFlat(EmitterRecord flatEmitter, vec3 position, vec3 n, vec2 u) {
    bool triangle = flatEmitter.kind == emitterTriangle;
    float s = sqrt(u.x);
    vec2 at = triangle ? vec2(s * (1.0 - u.y), s * u.y) : u;
    vec3 way = flatEmitter.corner + at.x * flatEmitter.u + at.y * flatEmitter.v - position;
    float d = length(way);
    float inverse = d > 0.0 ? 1.0 / d : 0.0;
    LightSample point;
    point.direction = d > 0.0 ? way * inverse : n;
    point.distance = d;
    // The area times the cosine at the emitter, over the squared distance: the lengths are divided out first.
    vec3 solid = cross(flatEmitter.u * inverse, flatEmitter.v * inverse);
    float seen = -dot(solid, point.direction);
    if (flatEmitter.bothSides > 0.5) seen = abs(seen);
    seen = max(seen, 0.0);
    float size = length(solid);
    point.facing = size > 0.0 ? seen / size : 0.0;
    point.light = flatEmitter.radiance * (seen * (triangle ? 0.5 : 1.0) * max(0.0, dot(n, point.direction)) / pi);
    return point;
}
#endif

#ifdef SPHERE_EMITTERS
LightSample sampleSphere(EmitterRecord sphere, vec3 position, vec3 n, vec2 u) {
    vec3 toCentre = sphere.corner - position;
    float d = length(toCentre);
    float radius = sphere.u.x;
    bool outside = radius < d;
    float inverse = outside ? 1.0 / d : 0.0;
    float sine = radius * inverse;
    // 1 - cos without cancellation for small spheres.
    float high = sine * sine / (1.0 + sqrt(max(0.0, 1.0 - sine * sine)));
    float down = u.x * high;
    float radial = sqrt(max(0.0, down * (2.0 - down)));
    float phi = 2.0 * pi * u.y;
    mat3 towards = basisAround(outside ? toCentre * inverse : n);
    LightSample point;
    point.direction = normalize(towards * vec3(radial * cos(phi), radial * sin(phi), 1.0 - down));
    float along = dot(toCentre, point.direction);
    float beside2 = max(0.0, d * d - along * along);
    point.distance = along - sqrt(max(0.0, radius * radius - beside2));
    point.facing = 1.0;
    // Solid angle 2 pi (1 - cos), irradiance over pi; inside of it nothing arrives.
    point.light = sphere.radiance * (outside ? 2.0 * high * max(0.0, dot(n, point.direction)) : 0.0);
    return point;
}
#endif

LightSample sampleLight(vec3 position, vec3 n, vec2 u) {
    uint index = chooseEmitter(u.x);
    int at = int(emitterRecordTexels * index);
    vec4 a = imageLoad(emitters, at);
    vec4 b = imageLoad(emitters, at + 1);
    vec4 c = imageLoad(emitters, at + 2);
    vec4 e = imageLoad(emitters, at + 3);
    EmitterRecord chosen = EmitterRecord(a.xyz, a.w, b.xyz, b.w, c.xyz, c.w, e.xyz, e.w);
    // What is left of the number is uniform again.
    float probability = max(chosen.probability, 1e-20);
    u.x = clamp((u.x - (chosen.upper - chosen.probability)) / probability, 0.0, 0.99999994);
    LightSample point;
#if defined(FLAT_EMITTERS) && defined(SPHERE_EMITTERS)
    if (chosen.kind == emitterSphere) {
        point = sampleSphere(chosen, position, n, u);
    } else {
        point = sampleFlat(chosen, position, n, u);
    }
#elif defined(SPHERE_EMITTERS)
    point = sampleSphere(chosen, position, n, u);
#else
    point = sampleFlat(chosen, position, n, u);
#endif
    point.light = emitterCount > 0u ? point.light / probability : vec3(0.0);
    return point;
}

float luminance(vec3 rgb) { return dot(rgb, vec3(0.2126, 0.7152, 0.0722)); }

bool isShadowed(Ray ray, LightSample point) {
#ifdef APPROXIMATE
    // What a proxy meets so close to the plane of the light may be the light's own surface. At a grazing angle a ray is
    // close to it for long, and brings little.
    Hit hit;
    return tracer_closestHit(ray, hit) && (ray.tMax - hit.t) * point.facing > hit.error;
#else
    return tracer_anyHit(ray);
#endif
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(result)))) return;

    float z = texelFetch(depth, pixel, 0).r;
    vec3 n = texelFetch(normal, pixel, 0).xyz;
    bool background = z == 0.0 || dot(n, n) == 0.0;
    n = background ? vec3(0.0, 0.0, 1.0) : normalize(n);
    vec3 origin = positionFromDepth(depthView, vec2(pixel) + 0.5, z);
    vec4 face = faceAt(pixel, n, depthView, origin, texelFetch(normal, pixel, 0).w);
    uint seed = pixelSeed(uvec2(pixel), randomShadow, frame.seed);

    vec3 light = vec3(0.0);
    float blocked = 0.0; // how bright what does not arrive is
    for (uint i = 0u; i < uint(RAYS); ++i) {
        ITERATION;
        vec2 u = scrambledSobol(frame.index * uint(TOTAL_RAYS) + uint(FIRST_RAY) + i, seed);
        LightSample point = sampleLight(origin, n, u);
        float bright = luminance(point.light);
        bool some = !background && bright > 0.0;
        Ray ray = surfaceRay(origin, n, point.direction);
        ray.tMax = some ? shortOfTheLight * point.distance : -1.0; // an empty interval: no tracer walks it
        tracer_aim(ray);
        bool leaves = leaveFace(ray, face); // else the surface itself is in the way
        bool shadowed = isShadowed(ray, point);
        bool arrives = leaves && !shadowed;
        if (some && arrives) light += point.light;
        if (some && !arrives) blocked += bright;
    }
    ITERATIONS_END;
#ifdef CONTINUES
    // Between steps the image holds sums.
    vec4 before = imageLoad(result, pixel);
    light += before.rgb;
    blocked += before.a;
#endif
#ifdef ENDS
    imageStore(result, pixel, vec4(light / float(TOTAL_RAYS), 1.0));
#ifdef VISIBILITY
    float arrived = luminance(light);
    imageStore(visibility, pixel, vec4(blocked > 0.0 ? arrived / (arrived + blocked) : 1.0));
#endif
#ifdef WEIGHT
    imageStore(weight, pixel, vec4((luminance(light) + blocked) / float(TOTAL_RAYS)));
#endif
#else
    imageStore(result, pixel, vec4(light, blocked));
#endif
}
