// Packs the base map into bricks (shared/occupancy_bricks.h), 32 of a row along z an invocation: a bit each of a word.
//
// OCCUPIED, first: whether a brick holds anything. CUBES, then: the same of the cubes of bricks that begin with it, for each
// of the eight ways (a work group a way) and for each size, as the union of eight cubes of half that size. Last the words:
// what they hold is there by bits of many bricks, and is turned.
#include "shared/occupancy_bricks.h"
#include "shared/occupancy.h"

const int rowWords = (BRICKS + 31) / 32;
const int mapWords = BRICKS * BRICKS * rowWords; // of all rows, for one size and way

// Where the rows of a size and way begin; of single bricks there is one way.
int cubesOf(int code, int way) { return code == 1 ? 0 : mapWords * (1 + (code - 2) * 8 + way); }

#ifdef CUBES

const int group = 256;
layout(local_size_x = group) in;
layout(r32ui) coherent uniform uimageBuffer cubes;

// Adds the cubes that begin in a row, none if it lies beyond the map.
void add(int first, ivec2 row, inout uint words[rowWords]) {
    bool within = (row.x | row.y) >= 0 && max(row.x, row.y) < BRICKS;
    int at = first + (within ? (row.y * BRICKS + row.x) * rowWords : 0);
    for (int i = 0; i < rowWords; ++i) {
        uint word = imageLoad(cubes, at + i).x;
        words[i] |= within ? word : 0u;
    }
}

void main() {
    int way = int(gl_WorkGroupID.x);
    ivec3 onward = 1 - 2 * (ivec3(way) >> ivec3(0, 1, 2) & 1);
    for (int code = 2; code <= CODES; ++code) {
        int by = 1 << (code - 2); // bricks
        int smaller = cubesOf(code - 1, way);
        int larger = cubesOf(code, way);
        for (int i = int(gl_LocalInvocationID.x); i < BRICKS * BRICKS; i += group) {
            ivec2 row = ivec2(i % BRICKS, i / BRICKS);
            ivec2 other = row + by * onward.xy;
            uint words[rowWords];
            for (int w = 0; w < rowWords; ++w) words[w] = 0u;
            add(smaller, row, words);
            add(smaller, ivec2(other.x, row.y), words);
            add(smaller, ivec2(row.x, other.y), words);
            add(smaller, other, words);
            for (int w = 0; w < rowWords; ++w) {
                uint above = w + 1 < rowWords ? words[min(w + 1, rowWords - 1)] : 0u;
                uint below = w > 0 ? words[max(w - 1, 0)] : 0u;
                uint onwards = onward.z > 0 ? (by == 32 ? above : words[w] >> uint(by) | above << uint(32 - by))
                                            : (by == 32 ? below : words[w] << uint(by) | below >> uint(32 - by));
                imageStore(cubes, larger + i * rowWords + w, uvec4(words[w] | onwards));
            }
        }
        memoryBarrierImage();
        barrier();
    }
}

#else

#include "occupancy/base_map.glsl"

layout(local_size_x = 64) in;

// Every other bit, from the lowest on.
uint halved(uint bits) {
    bits &= 0x55555555u;
    bits = (bits | bits >> 1u) & 0x33333333u;
    bits = (bits | bits >> 2u) & 0x0f0f0f0fu;
    bits = (bits | bits >> 4u) & 0x00ff00ffu;
    return (bits | bits >> 8u) & 0x0000ffffu;
}

// The cells of a column that lie in 32 bricks.
uvec2 cellsAt(ivec2 column, int word) {
    int z = 64 * word;
    return uvec2(BASE_WORD(occupancyWord(column.x, column.y, z, RESOLUTION)),
                 RESOLUTION < 64 ? 0u : BASE_WORD(occupancyWord(column.x, column.y, z + 32, RESOLUTION)));
}

#ifdef OCCUPIED

layout(std430) writeonly buffer Cubes { uint cubes[]; };

void main() {
    int i = int(gl_GlobalInvocationID.x);
    ivec2 column = 2 * ivec2(i / rowWords % BRICKS, i / rowWords / BRICKS);
    int word = i % rowWords;
    uvec2 cells = cellsAt(column, word) | cellsAt(column + ivec2(1, 0), word) | cellsAt(column + ivec2(0, 1), word) |
                  cellsAt(column + 1, word);
    cells |= cells >> 1u;
    cubes[i] = halved(cells.x) | halved(cells.y) << 16u;
}

#else

layout(r32ui) readonly uniform uimageBuffer cubes;
layout(std430) writeonly buffer Bricks { uvec4 bricks[]; };

uint emptyAt(int i, int code, int way) { return code > CODES ? 0u : ~imageLoad(cubes, cubesOf(code, way) + i).x; }

void main() {
    int i = int(gl_GlobalInvocationID.x);
    ivec2 column = 2 * ivec2(i / rowWords % BRICKS, i / rowWords / BRICKS);
    int word = i % rowWords;
    uint turned[32];
    for (int k = 0; k < 4; ++k) {
        uvec2 cells = cellsAt(column + ivec2(k & 1, k >> 1), word);
        turned[k] = halved(cells.x) | halved(cells.y) << 16u;
        turned[k + 4] = halved(cells.x >> 1u) | halved(cells.y >> 1u) << 16u;
    }
    // The number of sizes that are empty, all up to the largest: its three bits.
    uint single = emptyAt(i, 1, 0);
    for (int way = 0; way < 8; ++way) {
        uint of2 = emptyAt(i, 2, way), of3 = emptyAt(i, 3, way), of4 = emptyAt(i, 4, way);
        uint of5 = emptyAt(i, 5, way), of6 = emptyAt(i, 6, way), of7 = emptyAt(i, 7, way);
        turned[8 + 3 * way] = single & ~of2 | of3 & ~of4 | of5 & ~of6 | of7;
        turned[9 + 3 * way] = of2 & ~of4 | of6;
        turned[10 + 3 * way] = of4;
    }
    // Warren, "Hacker's Delight", section 7-3: halves, then quarters and so on change places across the diagonal.
#define TURN(distance, mask)                                                                                                 \
    for (int j = 0; j < 16; ++j) {                                                                                           \
        int low = (j & ~(distance - 1)) << 1 | (j & (distance - 1));                                                         \
        uint changed = (turned[low] >> uint(distance) ^ turned[low + distance]) & mask;                                      \
        turned[low + distance] ^= changed;                                                                                   \
        turned[low] ^= changed << uint(distance);                                                                            \
    }
    TURN(16, 0x0000ffffu)
    TURN(8, 0x00ff00ffu)
    TURN(4, 0x0f0f0f0fu)
    TURN(2, 0x33333333u)
    TURN(1, 0x55555555u)
    int first = (i / rowWords * BRICKS + 32 * word) / 4;
    for (int j = 0; j < min(BRICKS, 32) / 4; ++j)
        bricks[first + j] = uvec4(turned[4 * j], turned[4 * j + 1], turned[4 * j + 2], turned[4 * j + 3]);
}

#endif
#endif
