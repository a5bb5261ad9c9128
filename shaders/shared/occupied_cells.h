// The list of a map's occupied cells, and the ways that rotated maps are made (shaders/occupancy/scatter.comp).
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

// Ahead of the list in its buffer: how many there are, also those that found no room, and the work groups of the steps that
// make the maps, as indirect commands of 16 bytes each.
struct OccupiedCellsHeader {
    uint count;
    uint pad0;
    uint pad1;
    uint pad2;
    uvec4 blank;
    uvec4 scatter;
    uvec4 rotate;
};

const uint scatterGroup = 64u; // invocations
const uint scatterCells = 4u;  // cells that each takes, so that a map's axes are read once for all of them
const int rotateGroup = 8;     // invocations along x and y

// A cell as 10 bits an axis.
inline uint packCell(uint x, uint y, uint z) { return x | (y << 10u) | (z << 20u); }
inline ivec3 unpackCell(uint cell) {
    return ivec3(int(cell & 1023u), int((cell >> 10u) & 1023u), int(cell >> 20u));
}

SHARED_END
