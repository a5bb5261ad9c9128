// The scene's triangles in the view of the depth that was given; with MAP into the texels of a stochastic depth map, so that
// texel centres are where mapPlaceOf() of stochastic_depth/map.glsl says.
#include "lib/vertex.glsl"
#include "lib/view.glsl"

layout(std140) uniform ViewDepthView { ViewData depthView; };
#ifdef MAP
layout(std140) uniform DepthsView { ViewData mapView; };
#endif

out vec3 v_position;
out vec2 v_tex_coord;
out vec2 v_tex_coord1;
out float v_alpha;

void main() {
    v_position = in_position;
    v_tex_coord = in_tex_coord;
    v_tex_coord1 = in_tex_coord1;
    v_alpha = in_colour.a;
    gl_Position = depthView.projection * (depthView.view * vec4(in_position, 1.0));
#ifdef MAP
    // Pixel of the depth, pixel of the frame, texel of the map: each a scale and a shift.
    float divisor = float(mapView.divisor);
    vec2 scale = 0.5 * vec2(depthView.size) * float(depthView.divisor) / divisor;
    vec2 shift = scale - float(depthView.guard) * float(depthView.divisor) / divisor + float(mapView.guard);
    shift += 0.5 - (floor(0.5 * divisor) + 0.5) / divisor;
    vec2 size = 0.5 * vec2(mapView.size);
    gl_Position.xy = scale / size * gl_Position.xy + (shift / size - 1.0) * gl_Position.w;
#endif
}
