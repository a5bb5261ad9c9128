// Ambient occlusion slice by slice: planes through the line of sight, in which the depth is followed to both sides. Angles
// count from the direction to the eye, positive to the slice's own side. In each slice light is weighted by its solid angle
// and cosine, as in the whole hemisphere (Jimenez, Wu, Pesce, Jarabo, "Practical Real-Time Strategies for Accurate Indirect
// Occlusion", 2016, section 3).
//
// GTAO keeps the highest horizon of each side. BITMASK keeps 32 sectors of equal weight, and takes those away that lie between
// the front of a sample and its back, `thickness` behind (Therrien, Levesque, Gilet, "Screen Space Indirect Lighting with
// Visibility Bitmask", 2023): light passes behind what is thin.
#include "ambient_occlusion/eye_grid.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(r32f) uniform readonly image2D view_depth;
layout(rgba16f) uniform readonly image2D normal;
layout(r16f) uniform writeonly image2D visibility;
layout(std140) uniform ViewDepthView { ViewData depthView; };
uniform float radius;        // scene units
uniform float maximumRadius; // pixels of the frame
uniform float thickness;     // scene units
uniform float exponent;

const float halfPi = 1.5707963;

// The weight of a slice's light from the direction to the eye up to an angle of either sign.
float arc(float angle, float turn) {
    return 0.25 * (cos(turn) - cos(2.0 * angle - turn) + 2.0 * angle * sin(turn));
}

// The share of the light below an angle, from the slice's lowest one on.
float shareBelow(float angle, float turn, float low, float whole) {
    return clamp((low + sign(angle) * arc(angle, turn)) / whole, 0.0, 1.0);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(visibility)))) return;
    ivec2 at = pixel + int(depthView.guard);
    ivec2 size = ivec2(depthView.size);
    EyeGrid grid = eyeGrid(depthView);
    float depth = imageLoad(view_depth, at).r;
    vec2 centre = vec2(at) + 0.5;
    vec3 position = eyePosition(grid, centre, depthOrFar(depth));
    vec3 toEye = grid.parallel ? vec3(0.0, 0.0, 1.0) : -normalize(position);
    vec3 n = mat3(depthView.view) * imageLoad(normal, at).xyz;
    n = dot(n, toEye) < 0.0 ? -n : n;
    float perUnit = 0.5 * (grid.perUnit.x + grid.perUnit.y) / (grid.parallel ? 1.0 : depthOrFar(depth));
    float reach = min(radius * perUnit, maximumRadius / float(depthView.divisor));
    float far = reach / perUnit;

    // Of 4 x 4 pixels each has its own slices, and of each diagonal its own steps.
    float turned = (float(bitfieldReverse(uint((pixel.x ^ pixel.y) & 3)) >> 30) * 4.0 +
                    float(bitfieldReverse(uint(pixel.y & 3)) >> 30) + 0.5) / 16.0;
    float shift = (float((pixel.y - pixel.x) & 3) + 0.5) / 4.0;

    float open = 0.0;
    for (int slice = 0; slice < SLICES; ++slice) {
        float phi = 2.0 * halfPi * (float(slice) + turned) / float(SLICES);
        vec2 way = vec2(cos(phi), sin(phi));
        vec3 along = vec3(way, 0.0);
        along -= dot(along, toEye) * toEye;
        vec3 axis = normalize(cross(along, toEye));
        vec3 inSlice = n - axis * dot(n, axis);
        float weight = max(length(inSlice), 1e-4);
        float turn = acos(clamp(dot(inSlice, toEye) / weight, -1.0, 1.0)) * (dot(inSlice, along) < 0.0 ? -1.0 : 1.0);
        float low = arc(turn - halfPi, turn);
        float whole = low + arc(turn + halfPi, turn);
        vec2 horizon = cos(turn + vec2(-halfPi, halfPi)); // of the two sides, as cosines
        vec2 lowest = horizon;
        uint hidden = 0u;
        for (int i = 0; i < 2 * STEPS; ++i) {
            bool positive = i >= STEPS;
            float t = (float(positive ? i - STEPS : i) + shift) / float(STEPS);
            vec2 place = centre + (positive ? 1.0 : -1.0) * max(reach * t * t, 1.0) * way;
            ivec2 there = ivec2(floor(place));
            bool inside = all(greaterThanEqual(there, ivec2(0))) && all(lessThan(there, size));
            float z = inside ? imageLoad(view_depth, clamp(there, ivec2(0), size - 1)).r : 0.0;
            vec3 offset = eyePosition(grid, vec2(there) + 0.5, depthOrFar(z)) - position;
            float away = length(offset);
            bool counts = z > 0.0 && away < far && away > 0.0;
            float cosine = clamp(dot(offset, toEye) / away, -1.0, 1.0);
#ifdef BITMASK
            vec3 behind = offset - thickness * toEye;
            float front = acos(cosine);
            float back = acos(clamp(dot(behind, toEye) / length(behind), -1.0, 1.0));
            vec2 angles = clamp(positive ? vec2(front, back) : -vec2(back, front), turn - halfPi, turn + halfPi);
            uvec2 sectors = uvec2(round(32.0 * vec2(shareBelow(angles.x, turn, low, whole), shareBelow(angles.y, turn, low, whole))));
            uint upTo = sectors.y >= 32u ? 0xffffffffu : (1u << sectors.y) - 1u;
            uint from = sectors.x >= 32u ? 0xffffffffu : (1u << sectors.x) - 1u;
            if (counts) hidden |= upTo & ~from;
#else
            // Toward the radius a sample's horizon goes down to that of the hemisphere.
            float squared = away * away / (far * far);
            float told = mix(cosine, positive ? lowest.y : lowest.x, clamp(squared, 0.0, 1.0));
            if (counts && positive) horizon.y = max(horizon.y, told);
            if (counts && !positive) horizon.x = max(horizon.x, told);
#endif
        }
#ifdef BITMASK
        open += weight * whole * (1.0 - float(bitCount(hidden)) / 32.0);
#else
        float lower = max(-acos(clamp(horizon.x, -1.0, 1.0)), turn - halfPi);
        float upper = min(acos(clamp(horizon.y, -1.0, 1.0)), turn + halfPi);
        open += weight * (arc(lower, turn) + arc(upper, turn));
#endif
    }
    bool nothing = depth == 0.0 || reach < 1.0;
    float share = nothing ? 1.0 : clamp(open / float(SLICES), 0.0, 1.0);
    imageStore(visibility, pixel, vec4(pow(share, exponent)));
}
