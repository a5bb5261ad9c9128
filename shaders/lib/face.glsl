// The face that a surface point of a G-buffer lies on. Directions are drawn around the shading normal, which interpolation or
// a normal map bends away from the face, so some point below it, into the surface itself: nothing arrives from there. One
// rule for every ray that leaves a surface, on both sides of the C++/GLSL border: leavesFace() of shared/ray.h.
#include "lib/tracer.glsl"
#include "lib/view.glsl"
#include "shared/ray.h"

#ifdef FACE_NORMAL
uniform sampler2D face_normal;
#endif

// Unit normal of the face at a pixel, on the side of unit shading normal n, and how far along it a ray starts
// (rayStart() of shared/ray.h) from a position that the depth gives; by n where nothing tells it. `misplaced`: as the
// G-buffer's normal has it in w.
vec4 faceAt(ivec2 pixel, vec3 n, ViewData view, vec3 position, float misplaced) {
#ifdef FACE_NORMAL
    vec4 face = texelFetch(face_normal, pixel, 0);
    float size = dot(face.xyz, face.xyz);
    if (size > 0.0) return vec4(face.xyz * inversesqrt(size), face.w + 2.0 * misplaced);
#endif
    vec3 extent = abs(position);
    float start = rayStart(distance(view.position.xyz, position), max(extent.x, max(extent.y, extent.z)), 0.0);
    return vec4(n, start + 2.0 * misplaced);
}

// To be called after aim, which weighs by the shading normal: the ray starts off the face, and one that does not leave it
// gets an empty interval, which no tracer walks. Whether it leaves.
bool leaveFace(inout Ray ray, vec4 face) {
    ray.normal = face.xyz;
    ray.origin += face.w * face.xyz;
    bool leaves = leavesFace(ray.direction, face.xyz);
    if (!leaves) ray.tMax = -1.0;
    return leaves;
}
