// The module interface `layers`: depth samples behind the first surface, found by pixel. A provider defines, wrapped in M():
//
//     const int M(count)                            samples that a texel holds at most (K), as its descriptor says
//     ivec2 M(texel)(vec2 uv)                       the texel that answers for `uv`, the frame's position in [0, 1], y up; beyond
//                                                   the frame too, as far as the guard band reaches: clamped to the map
//     vec2 M(position)(ivec2 texel)                 the `uv` that the texel's samples were taken at, jitter included
//     float M(depth)(ivec2 texel, int layer)        distance along the view axis, scene units; noLayer if there is none
//
// In the order that Desc::depthLayers states. How the samples were taken (divisor, guard band, jitter) is in the module's
// Desc::view, where a consumer declares itself.
#define noLayer 3.0e38
