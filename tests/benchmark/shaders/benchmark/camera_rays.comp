// One ray a pixel through its middle, as a buffer of rays.
#include "lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D depth;
layout(std430) writeonly buffer Rays { vec4 rays[]; }; // RayRecord, texel by texel
layout(std140) uniform DepthView { ViewData depthView; };

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = textureSize(depth, 0);
    if (any(greaterThanEqual(pixel, size))) return;
    vec3 origin, direction;
    float tNear, tFar;
    cameraRay(depthView, vec2(pixel) + 0.5, origin, direction, tNear, tFar);
    int at = 3 * (pixel.y * size.x + pixel.x);
    rays[at] = vec4(origin, tNear);
    rays[at + 1] = vec4(direction, tFar);
    rays[at + 2] = vec4(vec3(0.0), uintBitsToFloat(1u));
}
