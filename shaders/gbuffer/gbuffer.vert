// Positions are already in render space (framework/scene/geometry.h); this adds the view and hands on what is shaded.
#include "lib/vertex.glsl"
#include "lib/view.glsl"

layout(std140) uniform DepthView { ViewData depthView; };

// Two steps with different targets must meet the same depths.
invariant gl_Position;

out vec3 v_position;
out vec3 v_normal;
out vec2 v_tex_coord;
out vec2 v_tex_coord1;
#ifdef MATERIAL_NORMAL_MAPS
out vec4 v_tangent;
#endif
#ifdef MATERIAL_COLOURS
out vec4 v_colour;
#endif
#ifdef MOVES
out vec3 v_previous_position;
#endif

void main() {
    v_position = in_position;
    v_normal = in_normal;
    v_tex_coord = in_tex_coord;
    v_tex_coord1 = in_tex_coord1;
#ifdef MATERIAL_NORMAL_MAPS
    v_tangent = in_tangent;
#endif
#ifdef MATERIAL_COLOURS
    v_colour = in_colour;
#endif
#ifdef MOVES
    v_previous_position = in_previous_position;
#endif
    // By way of eye space, as lib/view.glsl goes back: nothing cancels far from the middle of the scene.
    gl_Position = depthView.projection * (depthView.view * vec4(in_position, 1.0));
}
