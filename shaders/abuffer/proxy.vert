// Bounding boxes in place of what is in them (section 3.3, depth bounds stage), in VIEW; an instance is a box. A fragment lies
// where a triangle covers a pixel's centre, but for the rasterizer's grid (a part of a pixel) and rounding; a box that is
// larger by a pixel's footprint at its farthest corner to all sides covers each of these centres, and its faces lie on both
// sides of each depth.
#include "abuffer/views.glsl"

#ifdef CUBE
uniform uint face;
#endif
uniform samplerBuffer boxes; // two texels each: corners; w of the first: whether there is anything in it

out float v_depth;     // along the view's axis, scene units
flat out float v_least; // no depth of the view is smaller, scene units; and in a box that the eye is in all may be as small
flat out uint v_inside;

void main() {
    vec4 low = texelFetch(boxes, 2 * gl_InstanceID);
    vec4 high = texelFetch(boxes, 2 * gl_InstanceID + 1);
    vec3 eye = frameView.position.xyz;
    // Of a pixel at depth 1, or of parallel rays at any.
#ifdef CUBE
    float footprint = 2.0 / float(SIDE);
    bool parallel = false;
    float least = NEAR_PLANE;
    eye[face / 2u] -= face % 2u == 0u ? NEAR_PLANE : -NEAR_PLANE;
#else
    float footprint = max(length(frameView.rightward.xyz), length(frameView.upward.xyz));
    bool parallel = frameView.position.w != 0.0;
    float least = frameView.nearPlane;
#endif
    float farthest = length(max(abs(low.xyz - eye), abs(high.xyz - eye)));
    float slack = footprint * (parallel ? 1.0 : farthest) + 1e-5 * farthest;
    low.xyz -= slack;
    high.xyz += slack;
    v_inside = !parallel && all(lessThan(low.xyz - slack, eye)) && all(greaterThan(high.xyz + slack, eye)) ? 1u : 0u;
    v_least = 0.999 * least; // the depth of a fragment on the near plane is rounded

    // Two triangles a face: its axis, which side of it, and where along the two other axes.
    int corner = gl_VertexID % 6;
    int axis = gl_VertexID / 12;
    bool first = corner == 1 || corner == 2 || corner == 4;
    bool second = corner == 2 || corner == 4 || corner == 5;
    vec3 position;
    position[axis] = gl_VertexID / 6 % 2 == 1 ? high[axis] : low[axis];
    position[(axis + 1) % 3] = first ? high[(axis + 1) % 3] : low[(axis + 1) % 3];
    position[(axis + 2) % 3] = second ? high[(axis + 2) % 3] : low[(axis + 2) % 3];
    v_depth = 0.0;
    gl_Position = low.w != 0.0 ? seenFrom(VIEW, position, v_depth) : vec4(0.0, 0.0, 0.0, 1.0);
}
