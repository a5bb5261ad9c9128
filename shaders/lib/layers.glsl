// The module interface `layers`: depth samples by pixel, behind the first surface (an A-buffer's: all, the first among them). A
// provider defines, wrapped in M():
//
//     const int M(count)                            samples of a texel that can be asked for (K), as its descriptor says
//     ivec2 M(texel)(vec2 uv)                       the texel that answers for `uv`, the frame's position in [0, 1], y up; beyond
//                                                   the frame too, as far as the guard band reaches: clamped to the map
//     vec2 M(position)(ivec2 texel)                 the `uv` that the texel's samples were taken at, jitter included
//     float M(depth)(ivec2 texel, int layer)        distance along the view axis, scene units; noLayer if there is none
//
// In the order that Desc::depthLayers states. How the samples were taken (divisor, guard band, jitter) is in the module's
// Desc::view, where a consumer declares itself. One whose Desc says provides::Surface also walks through all samples that a texel
// holds, however many, with the triangles they lie on: nearest first, of equal depths the lower triangle.
//
//     LayerSurface M(firstSurface)(ivec2 texel)                     (if REQUESTS_SURFACE)
//     void M(nextSurface)(ivec2 texel, inout LayerSurface at)   (if REQUESTS_SURFACE)
#define noLayer 3.0e38

struct LayerSurface {
    float depth;   // as M(depth); noLayer: there is no more
    uint triangle; // its number in the scene (lib/scene.glsl)
    uvec2 token;   // the provider's own
};

#define noLayerSurface LayerSurface(noLayer, 0u, uvec2(0u))
