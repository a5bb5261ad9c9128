// Horizon-based ambient occlusion of the pixels of one place in the 4 x 4 pattern (Bavoil and Jansen 2013). Along each
// direction a few samples at whole numbers of four pixels, so that all of them have that place too: neighbours in a layer of
// DEINTERLEAVED depths, or every fourth pixel of the depth itself. The place alone decides how far the directions are turned
// and where the samples begin. An occluder counts by its elevation over the surface, and the less the farther it is
// (Bavoil, Sainz, Dimitrov, "Image-Space Horizon-Based Ambient Occlusion", 2008, with the sum in place of the highest).
#include "ambient_occlusion/eye_grid.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(r32f) uniform readonly image2D view_depth;
layout(rgba16f) uniform readonly image2D normal;
layout(r16f) uniform writeonly image2D visibility;
#ifdef DEINTERLEAVED
layout(r32f) uniform readonly image2DArray layers;
#endif
layout(std140) uniform ViewDepthView { ViewData depthView; };
uniform float radius;        // scene units
uniform float bias;
uniform float exponent;
uniform float maximumRadius; // pixels of the frame

const float twoPi = 6.2831853;

void main() {
    // Of the frame; in the image the guard band lies before it.
    ivec2 own = ivec2(gl_GlobalInvocationID.z & 3u, gl_GlobalInvocationID.z >> 2u);
    ivec2 pixel = 4 * ivec2(gl_GlobalInvocationID.xy) + own;
    if (any(greaterThanEqual(pixel, imageSize(visibility)))) return;
    ivec2 at = pixel + int(depthView.guard);
    ivec2 size = ivec2(depthView.size);
    ivec2 cell = at >> 2, place = at & 3;

    // Sixteen turns of less than a direction and sixteen first steps, neither like its neighbours'.
    uint turn = bitfieldReverse(uint((own.x ^ own.y) | own.y << 2)) >> 28u;
    uint start = bitfieldReverse(uint((own.x ^ own.y ^ 1) << 2 | own.x)) >> 28u;

    EyeGrid grid = eyeGrid(depthView);
    float depth = imageLoad(view_depth, at).r;
    vec3 position = eyePosition(grid, vec2(at) + 0.5, depthOrFar(depth));
    vec3 n = mat3(depthView.view) * imageLoad(normal, at).xyz;
    n = dot(n, position) > 0.0 && !grid.parallel ? -n : n;
    float perUnit = 0.5 * (grid.perUnit.x + grid.perUnit.y) / (grid.parallel ? 1.0 : depthOrFar(depth));
    float reach = min(radius * perUnit, maximumRadius / float(depthView.divisor));
    float perRadius = perUnit / reach;
    float stride = reach / (4.0 * float(STEPS + 1)); // cells

    float sum = 0.0;
    for (int i = 0; i < DIRECTIONS; ++i) {
        float angle = (float(i) + (float(turn) + 0.5) / 16.0) * (twoPi / float(DIRECTIONS));
        vec2 way = vec2(cos(angle), sin(angle));
        for (int k = 0; k < STEPS; ++k) {
            ivec2 there = cell + ivec2(round((1.0 + stride * (float(k) + (float(start) + 0.5) / 16.0)) * way));
            ivec2 pixelThere = 4 * there + place;
#ifdef DEINTERLEAVED
            float z = imageLoad(layers, ivec3(clamp(there, ivec2(0), (size - 1) >> 2), place.x + 4 * place.y)).r;
#else
            float z = imageLoad(view_depth, clamp(pixelThere, ivec2(0), size - 1)).r;
#endif
            bool inside = all(greaterThanEqual(there, ivec2(0))) && all(lessThan(pixelThere, size));
            vec3 way3 = eyePosition(grid, vec2(pixelThere) + 0.5, depthOrFar(z)) - position;
            float squared = dot(way3, way3);
            float elevation = clamp(dot(n, way3) * inversesqrt(max(squared, 1e-30)) - bias, 0.0, 1.0);
            float falloff = clamp(1.0 - squared * perRadius * perRadius, 0.0, 1.0);
            if (inside && z > 0.0) sum += elevation * falloff;
        }
    }
    bool open = depth == 0.0 || reach < 1.0;
    float share = open ? 1.0 : clamp(1.0 - 2.0 * sum / float(DIRECTIONS * STEPS), 0.0, 1.0);
    imageStore(visibility, pixel, vec4(pow(share, exponent)));
}
