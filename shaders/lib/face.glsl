// The face that a surface point of a G-buffer lies on. Directions are drawn around the shading normal, which interpolation or
// a normal map bends away from the face, so some point below it, into the surface itself: nothing arrives from there. One
// rule for every ray that leaves a surface, on both sides of the C++/GLSL border: leavesFace() of shared/ray.h.
#include "lib/tracer.glsl"
#include "shared/ray.h"

#ifdef FACE_NORMAL
uniform sampler2D face_normal;
#endif

// Unit normal of the face at a pixel, on the side of unit shading normal n; n where nothing tells it.
vec3 faceAt(ivec2 pixel, vec3 n) {
#ifdef FACE_NORMAL
    vec3 face = texelFetch(face_normal, pixel, 0).xyz;
    float size = dot(face, face);
    return size > 0.0 ? face * inversesqrt(size) : n;
#else
    return n;
#endif
}

// To be called after aim, which weighs by the shading normal: the ray starts off the face, and one that does not leave it
// gets an empty interval, which no tracer walks. Whether it leaves.
bool leaveFace(inout Ray ray, vec3 face) {
    ray.normal = face;
    bool leaves = leavesFace(ray.direction, face);
    if (!leaves) ray.tMax = -1.0;
    return leaves;
}
