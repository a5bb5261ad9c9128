// A fragment of transparency/scene.vert.
#include "lib/fragment.glsl"

in vec2 v_tex_coord;
in vec2 v_tex_coord1;
in float v_alpha;
in float v_depth;

uniform sampler2D depth; // reversed, of what is opaque

// Whether it is blended, and not behind what is opaque.
bool fragmentIsSeen() {
    return gl_FragCoord.z > texelFetch(depth, ivec2(gl_FragCoord.xy), 0).r &&
           materialCovers(fragmentMaterial(), v_tex_coord, v_tex_coord1, v_alpha);
}
