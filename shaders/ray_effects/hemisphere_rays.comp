// The first ray of each pixel of RayAmbientOcclusion, bit for bit, so that their results can be compared ray by ray.
// One that would not leave its face does not exist.
#include "lib/frame.glsl"
#include "lib/view.glsl"
#include "lib/sampling.glsl"
#include "shared/random.h"
#include "lib/face.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D depth;
layout(rgba16f) uniform readonly image2D normal;
layout(std430) writeonly buffer Rays { vec4 rays[]; }; // RayRecord, texel by texel
layout(std140) uniform DepthView { ViewData depthView; };
uniform float maximumDistance; // 0: unbounded

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(normal);
    if (any(greaterThanEqual(pixel, size))) return;

    float z = texelFetch(depth, pixel, 0).r;
    vec3 n = imageLoad(normal, pixel).xyz;
    bool background = z == 0.0 || dot(n, n) == 0.0;
    n = background ? vec3(0.0, 0.0, 1.0) : normalize(n);
    vec3 position = positionFromDepth(depthView, vec2(pixel) + 0.5, z);
    vec4 face = faceAt(pixel, n, depthView, position, imageLoad(normal, pixel).w);
    vec2 u = scrambledSobol(frame.index, pixelSeed(uvec2(pixel), randomRayDirection, frame.seed));
    float tMax = maximumDistance > 0.0 ? maximumDistance : uintBitsToFloat(0x7f800000u);
    int at = 3 * (pixel.y * size.x + pixel.x);
    rays[at] = vec4(position + face.w * face.xyz, 0.0);
    vec3 direction = cosineHemisphere(u, n);
    bool exists = !background && leavesFace(direction, face.xyz);
    rays[at + 1] = vec4(direction, tMax);
    rays[at + 2] = vec4(face.xyz, uintBitsToFloat(exists ? 1u : 0u));
}
