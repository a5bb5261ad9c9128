// Least and largest depth of a pixel's fragments and how many there are, all by one blended attachment: the larger of the
// negated depth, the larger of the depth, and the sum of ones.
#include "lib/fragment.glsl"

in vec3 v_position;
in vec2 v_tex_coord;
in vec2 v_tex_coord1;
in float v_alpha;
in float v_depth;

#ifdef CUBE
out vec4 out_cube_bounds;
#define BOUNDS out_cube_bounds
#else
out vec4 out_bounds;
#define BOUNDS out_bounds
#endif

void main() {
#ifdef MATERIAL_MASKED
    if (!materialCovers(fragmentMaterial(), v_tex_coord, v_tex_coord1, v_alpha)) discard;
#endif
    BOUNDS = vec4(-v_depth, v_depth, 0.0, 1.0);
}
