// The nearest surface behind the first.
#include "lib/fragment.glsl"
#include "lib/view.glsl"
#include "shared/stochastic_depth.h"

in vec3 v_position;
in vec2 v_tex_coord;
in vec2 v_tex_coord1;
in float v_alpha;

layout(std140) uniform ViewDepthView { ViewData depthView; };
layout(r32f) uniform readonly image2D view_depth;
uniform float separation;

out float out_second_depth;

void main() {
#ifdef MATERIAL_MASKED
    if (!materialCovers(fragmentMaterial(), v_tex_coord, v_tex_coord1, v_alpha)) discard;
#endif
    float first = imageLoad(view_depth, ivec2(gl_FragCoord.xy)).r;
    float depth = -(depthView.view * vec4(v_position, 1.0)).z;
    if (first == 0.0 || depth <= first * (1.0 + depthSeparation) + separation) discard;
    out_second_depth = depth;
}
