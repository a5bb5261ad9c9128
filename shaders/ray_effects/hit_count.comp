// One ray a pixel through its centre, from the near to the far plane.
#include "lib/view.glsl"
#include "lib/hits.glsl"
#include "lib/iterations.glsl"

uint counted = 0u;
bool hits_visit(inout Ray ray, Hit hit) {
    ++counted;
    return false;
}
#include <port:hits>

layout(local_size_x = 8, local_size_y = 8) in;

layout(r32f) uniform writeonly image2D count;
layout(std140) uniform CountView { ViewData countView; };

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(count)))) return;
    vec3 origin, direction;
    float tNear, tFar;
    cameraRay(countView, vec2(pixel) + 0.5, origin, direction, tNear, tFar);
    Ray ray = surfaceRay(origin, vec3(0.0), direction);
    ray.tMin = tNear;
    ray.tMax = tFar;
    hits_all(ray);
    ITERATIONS_END;
    imageStore(count, pixel, vec4(float(counted)));
}
