// Finding a surface in the last frame: where it was, and whether what was seen there is the same surface.
// A record of `geometry`: unit normal in render space, distance along the view axis (0: nothing there).
#include "filter/signal.glsl"
#include "filter/records.glsl"

layout(std140) uniform DepthView { ViewData depthView; };
uniform sampler2D depth;
uniform sampler2D normal;

// The surface at a pixel now. Nothing where the depth or the normal is 0.
vec4 geometryAt(ivec2 pixel) {
    float z = texelFetch(depth, pixel, 0).r;
    vec3 n = texelFetch(normal, pixel, 0).xyz;
    float length2 = dot(n, n);
    return z > 0.0 && length2 > 0.0 ? vec4(n * inversesqrt(length2), viewDepth(depthView, z)) : vec4(0.0);
}

#ifdef PAST
layout(std140) uniform PREVIOUS_VIEW { ViewData previousView; };
RECORDS(vec4, rgba32f, previous_geometry, PreviousGeometry);
#ifdef MOTION
uniform sampler2D motion;
#endif
uniform float depthTolerance;  // of half the picture's height at that distance
uniform float normalTolerance; // cosine

struct Past {
    vec2 texel;       // where it was, in texels of the last frame: whole numbers are centres
    vec3 normal;      // as it is now
    ImagePlane plane; // through where it was, in the last frame's image
};

// Where the surface of a pixel was. Its distance from the eye in the last frame is known of what does not move itself;
// of the rest it is taken as if only the camera had moved, which the tolerance must bear.
Past pastOf(ivec2 pixel, vec4 surface) {
    Past past;
    past.texel = vec2(pixel);
#ifdef MOTION
    past.texel += texelFetch(motion, pixel, 0).xy;
#endif
    vec3 eye = eyePositionAt(depthView, vec2(pixel) + 0.5, surface.w);
    vec3 position = (depthView.inverseView * vec4(eye, 1.0)).xyz;
    float before = max(-(previousView.view * vec4(position, 1.0)).z, 0.0);
#ifdef MOTION
    // The images' samples stand off the pixel's centre by each frame's own jitter.
    vec2 at = past.texel + 0.5 + depthView.jitter - previousView.jitter;
#else
    vec2 at = past.texel + 0.5;
#endif
    past.normal = surface.xyz;
    vec3 eyeNormal = mat3(previousView.view) * surface.xyz;
    past.plane = imagePlane(previousView, eyeNormal, at, before, pictureScale(previousView, before));
    return past;
}

// Whether a texel of the last frame shows the same surface.
bool sameSurface(Past past, ivec2 texel, ivec2 size) {
    vec4 there = RECORD(previous_geometry, recordIndex(clamp(texel, ivec2(0), size - 1), size));
    bool inside = all(greaterThanEqual(texel, ivec2(0))) && all(lessThan(texel, size));
    // Comparisons with what is not a number (a surface at the eye has no scale) are false.
    return inside && there.w > 0.0 && dot(there.xyz, past.normal) >= normalTolerance &&
           abs(planeDistance(past.plane, vec2(texel) + 0.5, there.w)) <= depthTolerance;
}
#endif
