// The scene's triangles in one view of the A-buffer: the frame's, or with CUBE a face of the cube, whose eye stands the
// near distance behind the frame's, so that the six faces leave no gap about the eye (section 3.2).
#include "lib/vertex.glsl"
#include "shared/abuffer.h"
#include "shared/view.h"

layout(std140) uniform VIEW_BLOCK { ViewData frameView; };
#ifdef CUBE
uniform uint face;
#endif

out vec3 v_position;
out vec2 v_tex_coord;
out vec2 v_tex_coord1;
out float v_alpha;
out float v_depth; // along the view's axis, scene units

void main() {
    v_position = in_position;
    v_tex_coord = in_tex_coord;
    v_tex_coord1 = in_tex_coord1;
    v_alpha = in_colour.a;
#ifdef CUBE
    vec3 seen = abufferFaceAxes(face, in_position - frameView.position.xyz);
    v_depth = seen.z + NEAR_PLANE;
    // Reversed depth without a far plane: the near plane is where seen.z is 0.
    gl_Position = vec4(seen.xy, NEAR_PLANE, v_depth);
#else
    v_depth = -(frameView.view * vec4(in_position, 1.0)).z;
    gl_Position = frameView.viewProjection * vec4(in_position, 1.0);
#endif
}
