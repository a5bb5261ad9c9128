// The grid of an occupancy map: where it lies in render space, and where a cell's bit lies in memory.
//
// The map is a cube of N^3 cells, N = 32, 64, 128 or 256, one bit a cell. "Cell coordinates" are render space moved and
// scaled so that cell (x, y, z) is the box [x, x+1) x [y, y+1) x [z, z+1); "centred" ones have the cube's centre at 0.
//
// The base map is a buffer of 32-bit words in N/32 slices of N x N: bit z & 31 of word (z / 32 * N + y) * N + x is cell
// (x, y, z). Neighbours along x are neighbours in memory: invocations side by side fetch from the same cache line, which
// measures faster for rotating than keeping a column's words together.
//
// A rotated map (Roma) stores the N/32 words of its column (x, y) together: a query reads one column.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

// The uniform block `Grid` (std140).
struct OccupancyGrid {
    vec3 centre;           // of the cube, render space
    float cellSize;        // render-space length of a cell's edge
    float inverseCellSize;
    float halfResolution;   // N / 2
    uint resolution;       // N
    float pad0;
    vec3 low;               // centred cells: the box that all occupied cells lie in, the whole cube if nothing is known
    float pad1;
    vec3 high;
    float pad2;
};

// Where rays through a map begin (occupancyBegin() of shaders/lib/occupancy.glsl). 16 bytes of a uniform block (std140).
struct OccupancySettings {
    float originOffset; // along the ray's normal, in cells
    float skip;         // along the ray, in cells: how far rays from a surface go before anything counts
    float pad1;
    float pad2;
};

inline vec3 centredCells(OccupancyGrid grid, vec3 position) { return (position - grid.centre) * grid.inverseCellSize; }

inline vec3 cellsOf(OccupancyGrid grid, vec3 position) { return centredCells(grid, position) + vec3(grid.halfResolution); }

inline vec3 fromCells(OccupancyGrid grid, vec3 cells) {
    return grid.centre + (cells - vec3(grid.halfResolution)) * grid.cellSize;
}

inline int occupancyWord(int x, int y, int z, int resolution) { return ((z >> 5) * resolution + y) * resolution + x; }

// Where level `level` of a hierarchy over columns begins: level 0 are the map's N x N columns, row by row, and each coarser
// level has half as many along x and y.
inline int occupancyLevelStart(int level, int resolution) {
    return (4 * resolution * resolution - ((4 * resolution * resolution) >> (2 * level))) / 3;
}

// The bits from cell `first` to cell `last`, both inclusive, of the word that holds cells 32 w to 32 w + 31 of a column.
// Either may lie outside it.
inline uint columnMask(int first, int last, int w) {
    uint upTo = ~(0xfffffffeu << uint(last & 31));
    uint from = 0xffffffffu << uint(first & 31);
    uint below = w < (last >> 5) ? 0xffffffffu : (w == (last >> 5) ? upTo : 0u);
    uint above = w > (first >> 5) ? 0xffffffffu : (w == (first >> 5) ? from : 0u);
    return below & above;
}

SHARED_END
