// Lists the occupied cells of a base map, for scatter.comp; with CHOOSE, one invocation then decides from their number how
// the maps are rotated, and writes the work groups of the steps that may follow (shared/occupied_cells.h).
#ifndef CHOOSE
#include "occupancy/base_map.glsl"
#endif
#include "occupancy/rotation.glsl"
#include "occupancy/cell_lists.glsl"

layout(local_size_x = 64) in;

#ifdef CHOOSE
#include "occupancy/grids.glsl"
uniform uint mapCount; // that are made in this frame

// Whether scattering so many cells takes less time than visiting all that a map has in the box. On a CPU driver a cell to
// scatter costs as much as 24 to visit, and as a column to begin with (measured on six scenes of 17 to 230 thousand cells).
bool worthScattering(uint count) {
    vec3 size = GRID.high - GRID.low;
    return float(count) <= float(RESOLUTION * RESOLUTION) + size.x * size.y * size.z / 24.0;
}

void main() {
    if (gl_GlobalInvocationID.x > 0u) return;
    const uint capacity = uint(CELLS);
    uint count = LIST.header.count;
    bool scatter = count <= capacity && worthScattering(count);
    const uint columns = uint(RESOLUTION / rotateGroup);
    uint groups = (count + scatterGroup * scatterCells - 1u) / (scatterGroup * scatterCells);
    const uint blank = uint(RESOLUTION * RESOLUTION * WORDS) / (4u * scatterGroup);
    LIST.header.blank = scatter ? uvec4(blank, mapCount, 1u, 0u) : uvec4(0u);
    LIST.header.scatter = scatter ? uvec4(max(groups, 1u), mapCount, 1u, 0u) : uvec4(0u);
    LIST.header.rotate = scatter ? uvec4(0u) : uvec4(columns, columns, mapCount, 0u);
}
#else
void main() {
    int index = int(gl_GlobalInvocationID.x);
    const uint capacity = uint(CELLS);
    uint word = BASE_WORD(FIRST_WORD + index);
    if (word == 0u) return;
    uint at = atomicAdd(LIST.header.count, uint(bitCount(word)));
    // occupancyWord() backwards.
    uint column = uint(index & (RESOLUTION * RESOLUTION - 1));
    uint z = uint(index / (RESOLUTION * RESOLUTION)) * 32u;
    while (word != 0u) {
        if (at < capacity) LIST.cells[at] = packCell(column % uint(RESOLUTION), column / uint(RESOLUTION), z + uint(findLSB(word)));
        ++at;
        word &= word - 1u;
    }
}
#endif
