// The LAYERS nearest fragments of a pixel, by drawing twice (Liu et al., "Single Pass Depth Peeling via CUDA Rasterizer", 2009,
// for the depths). Each depth sinks through the slots, which keep the smaller of two and hand on the larger; with TRIANGLES the
// same fragments find their depths there, and of equal ones triangles sink likewise.
#include "transparency/fragment.glsl"

layout(r32ui) uniform uimage2DArray depths; // bits of the depth along the view's axis
#ifdef TRIANGLES
layout(r32ui) uniform uimage2DArray triangles;
#endif

const uint none = 0x7f800000u; // the bits of infinity; there are fewer triangles

void main() {
    if (!fragmentIsSeen()) discard;
    ivec2 texel = ivec2(gl_FragCoord.xy);
    uint bits = floatBitsToUint(v_depth);
#ifdef TRIANGLES
    uint triangle = fragmentTriangle();
    for (int i = 0; i < LAYERS && triangle != none; ++i) {
        uint slot = imageLoad(depths, ivec3(texel, i)).r;
        if (slot > bits) break;
        if (slot == bits) triangle = max(triangle, imageAtomicMin(triangles, ivec3(texel, i), triangle));
    }
#else
    // What the last slot holds only becomes less.
    if (imageLoad(depths, ivec3(texel, LAYERS - 1)).r <= bits) discard;
    for (int i = 0; i < LAYERS && bits != none; ++i) bits = max(bits, imageAtomicMin(depths, ivec3(texel, i), bits));
#endif
}
