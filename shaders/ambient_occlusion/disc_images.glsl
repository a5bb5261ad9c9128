// What the passes of disc.glsl know of a pixel: depth and normal, with a guard band around the frame.
#include "ambient_occlusion/disc.glsl"

layout(r32f) uniform readonly image2D view_depth;
layout(rgba16f) uniform readonly image2D normal;
#ifdef DUAL
layout(r32f) uniform readonly image2D second_depth;
#endif
layout(std140) uniform ViewDepthView { ViewData depthView; };

// `pixel` counts from the frame's corner.
DiscPoint pointAt(EyeGrid grid, ivec2 pixel, out float depth) {
    ivec2 at = pixel + int(depthView.guard);
    depth = imageLoad(view_depth, at).r;
    vec3 eyeNormal = mat3(depthView.view) * imageLoad(normal, at).xyz;
    return discPoint(grid, vec2(at) + 0.5, depthOrFar(depth), eyeNormal, pixel, float(depthView.divisor));
}

// What the depth shows at a sample: its contribution and height, and whether that may hide what occludes.
float firstContribution(EyeGrid grid, DiscPoint point, DiscSample s, out float height, out bool hidden) {
    vec2 place = vec2(s.pixel) + 0.5;
    float first = depthOrFar(imageLoad(view_depth, s.pixel).r);
    height = heightAt(point, place, first);
    float value = contributionAt(grid, point, s, place, first, height);
    hidden = mayHide(point, s, height);
#ifdef DUAL
    float second = depthOrFar(imageLoad(second_depth, s.pixel).r);
    if (hidden) {
        float other = heightAt(point, place, second);
        value = min(value, contributionAt(grid, point, s, place, second, other));
        height = min(height, other);
        hidden = mayHide(point, s, height);
    }
#endif
    return s.self ? s.whole : value;
}
