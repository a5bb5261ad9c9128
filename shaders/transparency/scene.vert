// Blended triangles in the view of the opaque depth, at the depths that the G-buffer would give them.
#include "lib/vertex.glsl"
#include "lib/view.glsl"

layout(std140) uniform DepthView { ViewData depthView; };

// Steps that draw them again must meet the same depths.
invariant gl_Position;

out vec2 v_tex_coord;
out vec2 v_tex_coord1;
out float v_alpha;
out float v_depth; // along the view's axis, scene units

void main() {
    vec4 eye = depthView.view * vec4(in_position, 1.0);
    v_tex_coord = in_tex_coord;
    v_tex_coord1 = in_tex_coord1;
    v_alpha = in_colour.a;
    v_depth = -eye.z;
    gl_Position = depthView.projection * eye;
}
