// How the views of an A-buffer see a point of render space. View 0 is the frame's; 1 + face a face of the cube, whose eye stands
// the near distance behind the frame's, so that the six faces leave no gap about the eye (section 3.2).
#include "shared/abuffer.h"
#include "shared/view.h"

layout(std140) uniform VIEW_BLOCK { ViewData frameView; };

// The place in clip space, and the depth along the view's axis, scene units.
vec4 seenFrom(uint view, vec3 position, out float depth) {
    if (view == 0u) {
        depth = -(frameView.view * vec4(position, 1.0)).z;
        return frameView.viewProjection * vec4(position, 1.0);
    }
    vec3 seen = abufferFaceAxes(view - 1u, position - frameView.position.xyz);
    depth = seen.z + NEAR_PLANE;
    // Reversed depth without a far plane: the near plane is where seen.z is 0.
    return vec4(seen.xy, NEAR_PLANE, depth);
}

// Least and largest depth of a triangle.
vec2 depthsOf(uint view, vec3 p0, vec3 p1, vec3 p2) {
    vec3 depths;
    seenFrom(view, p0, depths.x);
    seenFrom(view, p1, depths.y);
    seenFrom(view, p2, depths.z);
    return vec2(min(depths.x, min(depths.y, depths.z)), max(depths.x, max(depths.y, depths.z)));
}
