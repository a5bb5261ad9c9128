// RAYS closest-hit queries a pixel over the specular lobe of its surface. Microfacet normals are drawn from those that the
// eye sees (Heitz 2018), so that a ray counts Fresnel times G2 / G1, never more than 1.
#include "lib/frame.glsl"
#include "lib/view.glsl"
#include "lib/sampling.glsl"
#include "shared/random.h"
#include "shared/ggx.h"
#include "lib/face.glsl"
#include "lib/radiance.glsl"
#include "lib/iterations.glsl"
#include <port:tracer>
#include <port:radiance>

layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D depth;
uniform sampler2D albedo;
uniform sampler2D material;
layout(rgba16f) uniform readonly image2D normal;
layout(rgba32f) uniform image2D result;
layout(std140) uniform DepthView { ViewData depthView; };
uniform float maximumDistance; // 0: infinite
uniform float maximumRoughness;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(result)))) return;

    float z = texelFetch(depth, pixel, 0).r;
    vec3 n = imageLoad(normal, pixel).xyz;
    bool background = z == 0.0 || dot(n, n) == 0.0;
    n = background ? vec3(0.0, 0.0, 1.0) : normalize(n);
    vec3 origin = positionFromDepth(depthView, vec2(pixel) + 0.5, z);
    vec4 face = faceAt(pixel, n, depthView, origin, imageLoad(normal, pixel).w);
    vec3 surface = texelFetch(material, pixel, 0).xyz;
    bool traced = !background && surface.x <= maximumRoughness && surface.z < 0.5;
    float alpha = ggxAlpha(surface.x);
    vec3 f0 = mix(vec3(dielectricReflectance), texelFetch(albedo, pixel, 0).rgb, surface.y);
    mat3 frameOfNormal = basisAround(n);
    vec3 view = background ? vec3(0.0, 0.0, 1.0) : towardsEye(depthView, origin) * frameOfNormal;
    uint seed = pixelSeed(uvec2(pixel), randomGlossy, frame.seed);

    vec3 light = vec3(0.0);
    for (uint i = 0u; i < uint(RAYS); ++i) {
        ITERATION;
        vec2 u = scrambledSobol(frame.index * uint(TOTAL_RAYS) + uint(FIRST_RAY) + i, seed);
        vec3 facet = ggxVisibleNormal(view, alpha, u);
        vec3 leaving = 2.0 * dot(view, facet) * facet - view;
        bool up = traced && leaving.z > 0.0;
        Ray ray = surfaceRay(origin, n, normalize(frameOfNormal * leaving));
        if (maximumDistance > 0.0) ray.tMax = maximumDistance;
        tracer_aim(ray);
        up = leaveFace(ray, face) && up;
        if (!up) ray.tMax = -1.0; // an empty interval: no tracer walks it
        Hit hit;
        vec3 arriving;
        if (tracer_closestHit(ray, hit)) {
#ifdef REQUIRES_SURFACE
            arriving = radiance_surface(tracer_surface(ray, hit), -ray.direction);
#else
            arriving = radiance_surface(facingSurface(ray, hit), -ray.direction);
#endif
        } else {
            arriving = radiance_miss(ray.direction);
        }
        vec3 share = schlickFresnel(f0, dot(view, facet)) * ggxShadowing(view.z, leaving.z, alpha);
        if (up) light += share * arriving;
    }
    ITERATIONS_END;
#ifdef CONTINUES
    light += imageLoad(result, pixel).rgb; // between steps the image holds sums
#endif
#ifdef ENDS
    light /= float(TOTAL_RAYS);
#endif
    imageStore(result, pixel, vec4(light, 1.0));
}
