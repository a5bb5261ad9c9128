// The nearest blended fragment behind those of the layer before (Everitt, "Interactive Order-Independent Transparency", 2001).
#include "transparency/fragment.glsl"

#ifdef BEHIND
layout(r32f) uniform readonly image2D peeled;
#endif

out float out_peeled; // reversed depth
out uint out_triangles;

void main() {
    if (!fragmentIsSeen()) discard;
#ifdef BEHIND
    if (gl_FragCoord.z >= imageLoad(peeled, ivec2(gl_FragCoord.xy)).r) discard;
#endif
    out_peeled = gl_FragCoord.z;
    out_triangles = fragmentTriangle();
}
