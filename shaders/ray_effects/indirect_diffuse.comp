// RAYS closest-hit queries a pixel over the cosine-weighted hemisphere, each asking what light leaves the hit towards the
// pixel (ROMA paper, section 5). How replaced directions count, and why both estimators are ratios: see
// ambient_occlusion/ray_ambient_occlusion.comp; in a closed room of one radiance both give it exactly.
#include "lib/frame.glsl"
#include "lib/view.glsl"
#include "lib/sampling.glsl"
#include "shared/random.h"
#include "lib/face.glsl"
#include "lib/radiance.glsl"
#include "lib/iterations.glsl"
#include <port:tracer>
#include <port:radiance>

layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D depth;
layout(rgba16f) uniform readonly image2D normal;
layout(rgba32f) uniform image2D result;
#ifdef WEIGHT
layout(r32f) uniform image2D weight;
#endif
layout(std140) uniform DepthView { ViewData depthView; };
uniform float maximumDistance; // 0: infinite

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(result)))) return;

    float z = texelFetch(depth, pixel, 0).r;
    vec3 n = imageLoad(normal, pixel).xyz;
    bool background = z == 0.0 || dot(n, n) == 0.0;
    n = background ? vec3(0.0, 0.0, 1.0) : normalize(n);
    vec3 origin = positionFromDepth(depthView, vec2(pixel) + 0.5, z);
    vec4 face = faceAt(pixel, n, depthView, origin, imageLoad(normal, pixel).w);
    uint seed = pixelSeed(uvec2(pixel), randomIndirect, frame.seed);

    vec3 light = vec3(0.0);
    float sum = 0.0;
    for (uint i = 0u; i < uint(RAYS); ++i) {
        ITERATION;
        vec2 u = scrambledSobol(frame.index * uint(TOTAL_RAYS) + uint(FIRST_RAY) + i, seed);
        Ray ray = surfaceRay(origin, n, cosineHemisphere(u, n));
        if (maximumDistance > 0.0) ray.tMax = maximumDistance;
        tracer_aim(ray);
#ifdef COSINE_RATIO
        float w = ray.weight;
#else
        float w = ray.weight > 0.0 ? 1.0 : 0.0;
#endif
        bool leaves = leaveFace(ray, face);
        if (background || w == 0.0) ray.tMax = -1.0; // an empty interval: no tracer walks it
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
        if (leaves) light += w * arriving;
        sum += w;
    }
    ITERATIONS_END;
#ifdef CONTINUES
    // Between steps the images hold sums.
    light += imageLoad(result, pixel).rgb;
#ifdef WEIGHT
    sum += imageLoad(weight, pixel).r;
#else
    sum += float(FIRST_RAY);
#endif
#endif
#ifdef ENDS
    // Where no candidate stood above the horizon nothing is known of this frame: weight 0.
    vec3 mean = sum > 0.0 ? light / sum : vec3(0.0);
    imageStore(result, pixel, vec4(background ? vec3(0.0) : mean, 1.0));
#ifdef WEIGHT
    imageStore(weight, pixel, vec4(background ? 1.0 : sum / float(TOTAL_RAYS)));
#endif
#else
    imageStore(result, pixel, vec4(light, 1.0));
#ifdef WEIGHT
    imageStore(weight, pixel, vec4(sum));
#endif
#endif
}
