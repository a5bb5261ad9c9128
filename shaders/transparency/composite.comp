// Blended surfaces in the order of their depths, from the eye on, over what is opaque: c + (1 - a) of what is behind, each.
//
// A step shades STEP surfaces of a pixel at most, SKIPPED have been before it: with CONTINUES `result` holds their sum, and in a
// what they let through; without ENDS it goes on to do so. The last step counts what is left over.
#include "lib/frame.glsl"
#include "lib/iterations.glsl"
#include "lib/layers.glsl"
#include "lib/view.glsl"
#ifdef RADIANCE
#include "lib/radiance.glsl"
#include <port:radiance>
#endif
#include <port:layers>
#include "transparency/surface.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D picture;
uniform sampler2D depth;
layout(std140) uniform DepthView { ViewData depthView; };
#ifdef CONTINUES
layout(rgba32f) uniform image2D result;
#else
layout(rgba32f) uniform writeonly image2D result;
#endif
#ifdef ENDS
layout(std430) buffer Longest { uint longest; };
#endif
uniform float cutoff;

const float most = 1e30; // sums and products stay finite

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(result)))) return;
    vec3 origin, direction;
    float tNear, tFar;
    cameraRay(depthView, vec2(pixel) + 0.5, origin, direction, tNear, tFar);
    float z = texelFetch(depth, pixel, 0).r;
    float opaque = z > 0.0 ? viewDepth(depthView, z) : noLayer;

    vec3 sum = vec3(0.0);
    float through = 1.0;
#ifdef CONTINUES
    vec4 before = imageLoad(result, pixel);
    sum = before.rgb;
    through = before.a;
#endif
    ivec2 texel = layers_texel((vec2(pixel) + 0.5) / vec2(frame.size));
    uint met = 0u;
    for (LayerSurface at = layers_firstSurface(texel); at.depth < opaque && through > cutoff; layers_nextSurface(texel, at)) {
        ITERATION;
        ++met;
        if (met <= uint(SKIPPED) || met > uint(SKIPPED + STEP)) continue;
        vec3 colour;
        float alpha;
        if (!blendedSurface(at.triangle, origin, direction, colour, alpha)) continue;
        sum += through * alpha * min(colour, vec3(most));
        through *= 1.0 - alpha;
    }
    ITERATIONS_END;
#ifdef ENDS
    if (met > uint(SKIPPED + STEP)) atomicMax(longest, met);
    vec4 behind = texelFetch(picture, pixel, 0);
    imageStore(result, pixel, vec4(min(sum + through * behind.rgb, vec3(most)), 1.0 - through * (1.0 - behind.a)));
#else
    imageStore(result, pixel, vec4(sum, through));
#endif
}
