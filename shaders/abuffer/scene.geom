// Each triangle once in every view (section 3.3, store stage).
#include "abuffer/views.glsl"
#include "abuffer/seen.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = 3 * (LAST_VIEW - FIRST_VIEW + 1)) out;

in SEEN corner[];
out SEEN seen;
invariant gl_Position;
#ifdef BY_NUMBER
flat in uint corner_triangle[];
flat out uint seen_triangle;
#ifdef PLANES
flat out vec2 seen_range;
#endif
#endif

void main() {
    for (uint view = uint(FIRST_VIEW); view <= uint(LAST_VIEW); ++view) {
#if defined(PLANES) && defined(BY_NUMBER)
        vec2 range = depthsOf(view, gl_in[0].gl_Position.xyz, gl_in[1].gl_Position.xyz, gl_in[2].gl_Position.xyz);
#endif
        for (int i = 0; i < 3; ++i) {
            gl_Position = seenFrom(view, gl_in[i].gl_Position.xyz, seen.depth);
#ifdef MATERIAL_MASKED
            seen.texCoord = corner[i].texCoord;
            seen.texCoord1 = corner[i].texCoord1;
            seen.alpha = corner[i].alpha;
#endif
            seen.view = view;
#ifdef BY_NUMBER
            seen_triangle = corner_triangle[0];
#ifdef PLANES
            seen_range = range;
#endif
#else
            gl_PrimitiveID = gl_PrimitiveIDIn;
#endif
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
