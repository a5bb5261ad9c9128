// Each triangle once in every view (section 3.3, store stage).
#include "abuffer/views.glsl"
#include "abuffer/seen.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = 3 * (LAST_VIEW - FIRST_VIEW + 1)) out;

in SEEN corner[];
out SEEN seen;

void main() {
    for (uint view = uint(FIRST_VIEW); view <= uint(LAST_VIEW); ++view) {
        for (int i = 0; i < 3; ++i) {
            gl_Position = seenFrom(view, gl_in[i].gl_Position.xyz, seen.depth);
#ifdef MATERIAL_MASKED
            seen.texCoord = corner[i].texCoord;
            seen.texCoord1 = corner[i].texCoord1;
            seen.alpha = corner[i].alpha;
#endif
            seen.view = view;
            gl_PrimitiveID = gl_PrimitiveIDIn;
#ifdef LAYERED
            gl_Layer = int(view) - 1;
#else
            gl_ViewportIndex = view == 0u ? 0 : 1;
#endif
            EmitVertex();
        }
        EndPrimitive();
    }
}
