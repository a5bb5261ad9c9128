// From pixels to space and back, by the view that an image was made with. Pixel coordinates count from the image's lower
// left corner, guard band included; the centre of a pixel is at + 0.5. Depth is reversed: 1 near, 0 far or nothing.
#include "shared/view.h"

// Eye-space position (looking along -z) of a depth at a pixel coordinate. Depth 0 of an infinite far plane is infinite.
vec3 eyePositionFromDepth(ViewData view, vec2 pixel, float depth) {
    vec2 ndc = pixel / vec2(view.size) * 2.0 - 1.0;
    vec4 eye = view.inverseProjection * vec4(ndc, depth, 1.0);
    return eye.xyz / eye.w;
}

// Distance along the viewing axis, positive in front of the eye.
float viewDepth(ViewData view, float depth) {
    return (view.corner.w * depth + view.rightward.w) / (view.upward.w * depth + view.ahead.w);
}

// Render-space position of a depth at a pixel coordinate. By a ray from the eye: worked out by two matrices
// it took a fifth of the time of an effect with one ray a pixel. Finite also where nothing is and the far plane infinite:
// no tracer knows an end to rays from nowhere (0 times infinity).
vec3 positionFromDepth(ViewData view, vec2 pixel, float depth) {
    float z = clamp(viewDepth(view, depth), -1e18, 1e18);
    vec3 way = view.corner.xyz + pixel.x * view.rightward.xyz + pixel.y * view.upward.xyz;
    return view.position.xyz + (view.position.w != 0.0 ? 1.0 : z) * way + z * view.ahead.xyz;
}

// Pixel coordinate and depth of a render-space position; false behind the eye. Outside the image where pixel is.
bool project(ViewData view, vec3 position, out vec2 pixel, out float depth) {
    vec4 clip = view.projection * (view.view * vec4(position, 1.0));
    pixel = (clip.xy / clip.w * 0.5 + 0.5) * vec2(view.size);
    depth = clip.z / clip.w;
    return clip.w > 0.0;
}

// The ray of a pixel coordinate: unit direction, from the near plane (tNear) to the far plane (tFar, infinite if there is
// none), as distances from the origin, which is the eye or, of an orthographic camera, on the plane of the eye.
void cameraRay(ViewData view, vec2 pixel, out vec3 origin, out vec3 direction, out float tNear, out float tFar) {
    const float infinity = uintBitsToFloat(0x7f800000u);
    vec3 onNear = eyePositionFromDepth(view, pixel, 1.0);
    bool orthographic = view.position.w != 0.0;
    vec3 eyeOrigin = orthographic ? vec3(onNear.xy, 0.0) : vec3(0.0);
    vec3 eyeDirection = orthographic ? vec3(0.0, 0.0, -1.0) : normalize(onNear);
    // Distances along the ray per unit of depth: 1 for parallel rays.
    float stretch = -1.0 / eyeDirection.z;
    origin = (view.inverseView * vec4(eyeOrigin, 1.0)).xyz;
    direction = normalize(mat3(view.inverseView) * eyeDirection);
    tNear = view.nearPlane * stretch;
    tFar = view.farPlane > 0.0 ? view.farPlane * stretch : infinity;
}

// Direction from a render-space position towards the eye, unit.
vec3 towardsEye(ViewData view, vec3 position) {
    if (view.position.w != 0.0) return normalize(view.inverseView[2].xyz);
    return normalize(view.position.xyz - position);
}
