// The second pass: the samples of the mask once more, with what lies behind the first surface. Each takes back what the
// first pass gave for it and contributes the least that any depth tells: those of a texel of `layers`, or with BY_HITS all
// along a ray, which is what layers sample.
//
// SAMPLE_BITS are the samples that this step takes; with CONTINUES and without ENDS, `delta` carries the sum from step to step.
#include "ambient_occlusion/disc_images.glsl"
#include "shared/stochastic_depth.h"
#include "shared/work_list.h"
#include "lib/frame.glsl"
#include "lib/iterations.glsl"

layout(local_size_x = 64) in;

layout(r16f) uniform readonly image2D mean;
layout(MASK_FORMAT) uniform readonly uimage2D mask;
layout(std430) readonly buffer Pixels {
    WorkListHeader header;
    uint items[];
} list;
#ifdef ENDS
layout(r16f) uniform writeonly image2D result;
#endif
#if defined(CONTINUES) || !defined(ENDS)
layout(r32f) uniform image2D delta;
#endif

#ifdef BY_HITS
#include "lib/hits.glsl"
DiscPoint hitPoint;
DiscSample hitSample;
vec3 hitOrigin, hitDirection; // of the ray, eye space
float hitLeast;
bool hits_visit(inout Ray ray, Hit hit) {
    hitLeast = min(hitLeast, contribution(hitPoint, hitSample, hitOrigin + hit.t * hitDirection));
    // Nothing can tell of more.
    return hitLeast <= (IS_HBAO ? -1.0 : 0.0);
}
#include <port:hits>

// The least contribution of all hits on the ray through a sample's pixel, from behind `height` on.
float behind(EyeGrid grid, DiscPoint point, DiscSample s, float height, float value) {
    vec2 place = floor(s.place) + 0.5;
    vec3 origin, direction;
    float tNear, tFar;
    cameraRay(depthView, place, origin, direction, tNear, tFar);
    hitDirection = mat3(depthView.view) * direction;
    hitOrigin = grid.parallel ? vec3(eyePosition(grid, place, 1.0).xy, 0.0) : vec3(0.0);
    float cosine = -dot(hitDirection, point.toEye);
    float top = s.outside < 0.0 ? min(height, reachOf(s)) : reachOf(s);
    Ray ray = surfaceRay(origin, vec3(0.0), direction);
    ray.tMin = max((point.away - top * point.radius) / cosine, tNear);
    ray.tMax = min((point.away - s.back * point.radius) / cosine, tFar);
    // Behind the first surface, which both would meet otherwise.
    if (s.outside < 0.0) ray.tMin = max(ray.tMin, imageLoad(view_depth, s.pixel).r * (1.0 + depthSeparation) / -hitDirection.z);
    hitPoint = point;
    hitSample = s;
    hitLeast = value;
    hits_all(ray);
    return hitLeast;
}
#else
#include "lib/layers.glsl"
#include <port:layers>

float behind(EyeGrid grid, DiscPoint point, DiscSample s, float height, float value) {
    vec2 scale = float(depthView.divisor) / vec2(frame.size);
    ivec2 texel = layers_texel((s.place - float(depthView.guard)) * scale);
    vec2 place = layers_position(texel) / scale + float(depthView.guard);
    for (int layer = 0; layer < layers_count; ++layer) {
        ITERATION;
        float depth = layers_depth(texel, layer);
        depth = depth < noLayer ? depth : depthOrFar(0.0);
        float told = contributionAt(grid, point, s, place, depth, heightAt(point, place, depth));
        value = min(value, told);
#ifdef IN_ORDER
        if (depth >= noLayer) break; // nor do the others hold any
#endif
    }
    return value;
}
#endif

void main() {
    if (gl_GlobalInvocationID.x >= list.header.count) return;
    ivec2 pixel = unpackPixel(list.items[gl_GlobalInvocationID.x]);
    EyeGrid grid = eyeGrid(depthView);
    float depth;
    DiscPoint point = pointAt(grid, pixel, depth);

    float change = 0.0;
    uint bits = imageLoad(mask, pixel).r & SAMPLE_BITS;
    while (bits != 0u) {
        ITERATION;
        int i = findLSB(bits);
        bits &= bits - 1u;
        DiscSample s = discSample(grid, point, ivec2(depthView.size), kernel.disc[i]);
        float height;
        bool hidden;
        float first = firstContribution(grid, point, s, height, hidden);
        change += behind(grid, point, s, height, s.outside < 0.0 ? first : s.whole) - first;
    }
    ITERATIONS_END;
#ifdef CONTINUES
    change += imageLoad(delta, pixel).r;
#endif
#ifdef ENDS
    float share = imageLoad(mean, pixel).r + 2.0 * change / float(kernel.samples);
    imageStore(result, pixel, vec4(finalVisibility(share)));
#else
    imageStore(delta, pixel, vec4(change));
#endif
}
