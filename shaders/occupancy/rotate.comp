// Rotates the base map towards every candidate direction (ROMA, section 4.1, algorithm 1): each cell of a rotated map
// takes the bit of the base cell that its centre lies in. One invocation writes one column of one map, WORDS words.
//
// The position is stepped in fixed-point integers. Against floats this measures 1.4 to 1.7 times faster on a CPU driver (no
// rounding, no conversion; one mask tells whether all three coordinates lie inside), and the bits are the same everywhere.
//
// Only the part of a column that lies within the box of occupied cells is stepped through, in parts of `stride` steps: the
// cube holds the scene's sphere, of which even a cubical box fills a third, and the sphere fills half of the cube. Parts of a
// constant number of steps, because a bound that is computed costs as much where it saves nothing.
#include "lib/occupancy.glsl"
#include "shared/roma.h"

layout(local_size_x = 8, local_size_y = 8) in;

#ifdef BASE_STORAGE
layout(std430) readonly buffer Occupancy { uint occupancy[]; };
#define BASE_WORD(index) occupancy[index]
#else
layout(r32ui) readonly uniform uimageBuffer occupancy;
#define BASE_WORD(index) imageLoad(occupancy, index).x
#endif

#if WORDS == 1
layout(std430) writeonly buffer Maps { uint maps[]; };
#elif WORDS == 2
layout(std430) writeonly buffer Maps { uvec2 maps[]; };
#else
layout(std430) writeonly buffer Maps { uvec4 maps[]; };
#endif

layout(std140) uniform Rotations { RomaRotation rotations[DIRECTIONS]; };

#ifdef IN_TURN
// The maps at these places of an order are made anew (Renewal of passes/occupancy/candidates.h).
uniform int firstPlace;
uniform int placeStride;
#define MAP(z) (((firstPlace + (z)) * placeStride) % DIRECTIONS)
#else
#define MAP(z) (z)
#endif

#ifdef LEVELS
// Several base maps one after the other; this step rotates one of them.
layout(std140) uniform Grids { OccupancyGrid grids[LEVELS]; };
uniform int level;
#define LOW grids[level].low
#define HIGH grids[level].high
#define FIRST_WORD (level * (RESOLUTION * RESOLUTION * WORDS))
#define FIRST_MAP (level * DIRECTIONS)
#else
layout(std140) uniform Grid { OccupancyGrid grid; };
#define LOW grid.low
#define HIGH grid.high
#define FIRST_WORD 0
#define FIRST_MAP 0
#endif

const int whole = romaFractionBits;

const int strideBits = 3;
const int stride = 1 << strideBits;

// The parts of a column, first and one past the last, that lie within the box of occupied cells: where a line from centred
// cell `from` by `along` a step enters and leaves it.
ivec2 partsWithin(vec3 from, vec3 along) {
    vec3 inverse = finiteInverse(along);
    vec3 a = (LOW - from) * inverse;
    vec3 b = (HIGH - from) * inverse;
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
    ivec3 position = ivec3((RESOLUTION / 2) << whole) + (2 * id.x + 1 - RESOLUTION) * halfX +
                     (2 * id.y + 1 - RESOLUTION) * halfY + (1 - RESOLUTION) * halfZ;
    ivec3 step_ = 2 * halfZ;
    const float cell = 1.0 / float(1 << whole);
    ivec2 parts = partsWithin(vec3(position) * cell - float(RESOLUTION / 2), vec3(step_) * cell);
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
