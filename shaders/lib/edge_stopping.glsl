// What tells one surface from another in image space: distance from a plane and angle between normals, both relative, so
// that neither the scene's scale nor the distance changes an answer.
#include "lib/view.glsl"

// Half the picture's height at a distance along the view axis: the unit of tolerances. In scene units.
float pictureScale(ViewData view, float viewDepth) {
    return (view.position.w != 0.0 ? 1.0 : viewDepth) / abs(view.projection[1][1]);
}

// Eye-space position of what stands at a pixel coordinate at a distance along the view axis. Needs no inverse.
vec3 eyePositionAt(ViewData view, vec2 pixel, float viewDepth) {
    mat4 p = view.projection;
    float w = view.position.w != 0.0 ? 1.0 : viewDepth;
    vec2 ndc = pixel / vec2(view.size) * 2.0 - 1.0;
    vec2 shift = vec2(p[2][0], p[2][1]) * viewDepth - vec2(p[3][0], p[3][1]);
    return vec3((ndc * w + shift) / vec2(p[0][0], p[1][1]), -viewDepth);
}

// A plane, as the distance from it of what is seen at a pixel coordinate q at the distance z along the view axis:
// z * (scaled.xy . q + scaled.z) + constant.xy . q + constant.z. Two multiply-adds a tap once q is fixed.
struct ImagePlane {
    vec3 scaled;   // counts z times: of a perspective view all of the position, of parallel rays its depth alone
    vec3 constant;
};

// The plane with this unit normal (eye space) through what stands at `pixel` at `viewDepth`; distances in units of
// `scale`.
ImagePlane imagePlane(ViewData view, vec3 normal, vec2 pixel, float viewDepth, float scale) {
    mat4 p = view.projection;
    bool orthographic = view.position.w != 0.0;
    vec2 k = normal.xy / vec2(p[0][0], p[1][1]);
    vec3 across = vec3(2.0 * k / vec2(view.size), -k.x - k.y); // normal . (ndc / focal length), linear in the pixel
    ImagePlane plane;
    plane.scaled = vec3(0.0, 0.0, dot(k, vec2(p[2][0], p[2][1])) - normal.z);
    plane.constant = vec3(0.0, 0.0, -dot(k, vec2(p[3][0], p[3][1])) - dot(normal, eyePositionAt(view, pixel, viewDepth)));
    if (orthographic)
        plane.constant += across;
    else
        plane.scaled += across;
    plane.scaled /= scale;
    plane.constant /= scale;
    return plane;
}

float planeDistance(ImagePlane plane, vec2 pixel, float viewDepth) {
    return viewDepth * (dot(plane.scaled.xy, pixel) + plane.scaled.z) + dot(plane.constant.xy, pixel) + plane.constant.z;
}

float luminance(vec3 colour) { return dot(colour, vec3(0.2126, 0.7152, 0.0722)); }
