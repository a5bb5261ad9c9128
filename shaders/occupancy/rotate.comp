// Rotates the base map towards every candidate direction (ROMA, section 4.1, algorithm 1): each cell of a rotated map
// takes the bit of the base cell that its centre lies in. One invocation writes one column of one map, WORDS words.
//
// The position is stepped in fixed-point integers. Against floats this measures 1.4 to 1.7 times faster on a CPU driver (no
// rounding, no conversion; one mask tells whether all three coordinates lie inside), and the bits are the same everywhere.
//
// Only the part of a column that lies within the box of occupied cells is stepped through, in parts of `stride` steps: the
// cube holds the scene's sphere, of which even a cubical box fills a third, and the sphere fills half of the cube. Parts of a
// constant number of steps, because a bound that is computed costs as much where it saves nothing.
#include "occupancy/base_map.glsl"
#include "occupancy/rotation.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

#if WORDS == 1
layout(std430) writeonly buffer Maps { uint maps[]; };
#elif WORDS == 2
layout(std430) writeonly buffer Maps { uvec2 maps[]; };
#else
layout(std430) writeonly buffer Maps { uvec4 maps[]; };
#endif

layout(std140) uniform Rotations { RomaRotation rotations[DIRECTIONS]; };

#include "occupancy/grids.glsl"

const int strideBits = 3;
const int stride = 1 << strideBits;

// The parts of a column, first and one past the last, that lie within the box of occupied cells: where the column's line
// from centred cell `from`, by one over `inverse` a step, enters and leaves it.
ivec2 partsWithin(vec3 from, vec3 inverse) {
    vec3 a = (GRID.low - from) * inverse;
    vec3 b = (GRID.high - from) * inverse;
    vec3 nearer = min(a, b);
    vec3 farther = max(a, b);
    float enters = max(nearer.x, max(nearer.y, nearer.z));
    float leaves = min(farther.x, min(farther.y, farther.z));
    ivec2 ends = ivec2(clamp(floor(vec2(enters, leaves + 1.0)), 0.0, float(RESOLUTION)));
    return enters <= leaves ? ivec2(ends.x >> strideBits, (ends.y + stride - 1) >> strideBits) : ivec2(0);
}

void main() {
    ivec3 id = ivec3(gl_GlobalInvocationID);
    int map = MAP(id.z);
    // Not as a copy of the struct: a CPU driver then takes 1.5 times as long for the whole.
    ivec3 halfX = rotations[map].halfX.xyz;
    ivec3 halfY = rotations[map].halfY.xyz;
    ivec3 halfZ = rotations[map].halfZ.xyz;
    ivec3 position = centreOf(ivec3(id.xy, 0), halfX, halfY, halfZ);
    ivec3 step_ = 2 * halfZ;
    // An axis that the column does not move along gets a slope far below any other's, so that nothing divides by zero.
    vec3 slope = mix(vec3(1e-3), vec3(step_), notEqual(step_, ivec3(0)));
    ivec2 parts = partsWithin(vec3(position) / float(1 << whole) - float(RESOLUTION / 2), float(1 << whole) / slope);
    position += stride * parts.x * step_;
    uint column[WORDS];
    for (int w = 0; w < WORDS; ++w) column[w] = 0u;
    for (int part = parts.x; part < parts.y; ++part) {
        uint bits = 0u;
        for (int i = 0; i < stride; ++i) {
            // With a mask at the end in place of the `if` the whole takes twice as long.
            if (((position.x | position.y | position.z) & ~((RESOLUTION << whole) - 1)) == 0) {
                // occupancyWord() by shifts: with multiplications the whole takes 1.4 times as long.
                int index = ((position.z >> (whole + 5)) << (2 * RESOLUTION_BITS)) |
                            ((position.y >> whole) << RESOLUTION_BITS) | (position.x >> whole);
                uint word = BASE_WORD(FIRST_WORD + index);
                bits |= ((word >> ((uint(position.z) >> uint(whole)) & 31u)) & 1u) << i;
            }
            position += step_;
        }
        bits <<= uint(part * stride & 31);
        for (int w = 0; w < WORDS; ++w) column[w] |= part * stride >> 5 == w ? bits : 0u;
    }
    int at = ((FIRST_MAP + map) * RESOLUTION + id.y) * RESOLUTION + id.x;
#if WORDS == 1
    maps[at] = column[0];
#elif WORDS == 2
    maps[at] = uvec2(column[0], column[1]);
#elif WORDS == 4
    maps[at] = uvec4(column[0], column[1], column[2], column[3]);
#else
    maps[2 * at] = uvec4(column[0], column[1], column[2], column[3]);
    maps[2 * at + 1] = uvec4(column[4], column[5], column[6], column[7]);
#endif
}
