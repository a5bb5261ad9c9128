// Every fragment behind the first surface goes into slots of its texel: each slot keeps the nearest that it is offered, by an
// atomic minimum of the bits of its depth. COVERAGE_MASK offers it to the slots of a random mask, RESERVOIR to the next slot
// or, when all are taken, to one of as many as there were fragments; K_BUFFER sinks it through the slots, each of which
// keeps the smaller of two and hands on the larger.
#include "lib/fragment.glsl"
#include "lib/frame.glsl"
#include "lib/view.glsl"
#include "stochastic_depth/map.glsl"

in vec3 v_position;
in vec2 v_tex_coord;
in vec2 v_tex_coord1;
in float v_alpha;

layout(std140) uniform ViewDepthView { ViewData depthView; };
layout(std140) uniform DepthsView { ViewData mapView; };
layout(r32f) uniform readonly image2D view_depth;
#ifdef INTERVAL
layout(r32ui) uniform readonly uimage2D ray_min;
layout(r32ui) uniform readonly uimage2D ray_max;
#elif !defined(WHOLE_MAP)
layout(r8ui) uniform readonly uimage2D sd_mask;
#endif
layout(r32ui) uniform uimage2DArray depths;
#ifdef RESERVOIR
layout(r32ui) uniform uimage2D counts;
#endif

void main() {
#ifdef MATERIAL_MASKED
    if (!materialCovers(fragmentMaterial(), v_tex_coord, v_tex_coord1, v_alpha)) discard;
#endif
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float depth = -(depthView.view * vec4(v_position, 1.0)).z;
    vec2 place = mapPlaceOf(mapView, texel, false) / float(depthView.divisor) + float(depthView.guard);
    ivec2 pixel = ivec2(floor(place));
    bool inside = all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, ivec2(depthView.size)));
    float first = inside ? imageLoad(view_depth, pixel).r : 0.0;
    if ((inside && first == 0.0) || depth <= first * (1.0 + depthSeparation)) discard;
#ifdef INTERVAL
    float away = depthView.position.w != 0.0 ? depth : distance(v_position, depthView.position.xyz);
    if (away < uintBitsToFloat(imageLoad(ray_min, texel).r) || away > uintBitsToFloat(imageLoad(ray_max, texel).r)) discard;
#elif !defined(WHOLE_MAP)
    if (imageLoad(sd_mask, texel).r == 0u) discard;
#endif
    uint bits = floatBitsToUint(depth);
#ifdef K_BUFFER
    for (int i = 0; i < LAYERS; ++i) bits = max(bits, imageAtomicMin(depths, ivec3(texel, i), bits));
#else
    uint seed = hashCombine(pixelSeed(uvec2(texel), randomStochasticDepth, frame.seed), fragmentTriangle());
#ifdef RESERVOIR
    uint count = imageAtomicAdd(counts, texel, 1u) + 1u;
    uint slot = count <= uint(LAYERS) ? count - 1u : uint(unitFloat(seed) * float(count));
    if (slot < uint(LAYERS)) imageAtomicMin(depths, ivec3(texel, int(slot)), bits);
#else
    uint mask = coverageMask(uint(LAYERS), coverageAlpha(uint(LAYERS)), unitFloat(seed), unitFloat(hashUint(seed)));
    for (int i = 0; i < LAYERS; ++i)
        if ((mask >> i & 1u) != 0u) imageAtomicMin(depths, ivec3(texel, i), bits);
#endif
#endif
}
