// What the tracers through occupancy maps share: columns of bits, and where rays begin. See shared/occupancy.h.
#include "lib/tracer.glsl"
#include "shared/occupancy.h"

// The cells along z at one (x, y), 32 a word; words beyond the map are 0. Where a map has fewer than eight words, the rest
// is known to the compiler, and what is computed with it goes.
struct OccupancyColumn {
    uvec4 low;
    uvec4 high;
};

OccupancyColumn columnOf(uint words) { return OccupancyColumn(uvec4(words, 0u, 0u, 0u), uvec4(0u)); }
OccupancyColumn columnOf(uvec2 words) { return OccupancyColumn(uvec4(words, 0u, 0u), uvec4(0u)); }
OccupancyColumn columnOf(uvec4 words) { return OccupancyColumn(words, uvec4(0u)); }
OccupancyColumn columnOf(uvec4 low, uvec4 high) { return OccupancyColumn(low, high); }

// Only the cells from `first` to `last`, both inclusive; none if last < first.
OccupancyColumn columnPart(OccupancyColumn column, int first, int last) {
    uvec4 low = uvec4(columnMask(first, last, 0), columnMask(first, last, 1), columnMask(first, last, 2),
                      columnMask(first, last, 3));
    uvec4 high = uvec4(columnMask(first, last, 4), columnMask(first, last, 5), columnMask(first, last, 6),
                       columnMask(first, last, 7));
    return OccupancyColumn(column.low & low, column.high & high);
}

// Whether any cell is occupied.
bool columnAny(OccupancyColumn column) {
    uvec4 found = column.low | column.high;
    return (found.x | found.y | found.z | found.w) != 0u;
}

int lowestIn(uint word, int first, int otherwise) { return word != 0u ? first + findLSB(word) : otherwise; }
int highestIn(uint word, int first, int otherwise) { return word != 0u ? first + findMSB(word) : otherwise; }

// The first occupied cell going up (or down); -1 if there is none.
int columnFirst(OccupancyColumn column, bool up) {
    int lowest = lowestIn(column.high.w, 224, -1);
    lowest = lowestIn(column.high.z, 192, lowest);
    lowest = lowestIn(column.high.y, 160, lowest);
    lowest = lowestIn(column.high.x, 128, lowest);
    lowest = lowestIn(column.low.w, 96, lowest);
    lowest = lowestIn(column.low.z, 64, lowest);
    lowest = lowestIn(column.low.y, 32, lowest);
    lowest = lowestIn(column.low.x, 0, lowest);
    int highest = highestIn(column.low.x, 0, -1);
    highest = highestIn(column.low.y, 32, highest);
    highest = highestIn(column.low.z, 64, highest);
    highest = highestIn(column.low.w, 96, highest);
    highest = highestIn(column.high.x, 128, highest);
    highest = highestIn(column.high.y, 160, highest);
    highest = highestIn(column.high.z, 192, highest);
    highest = highestIn(column.high.w, 224, highest);
    return up ? lowest : highest;
}

// The cell that z lies in; -1 below the map and `resolution` above it, which columnPart() takes for no cell.
int cellAt(float z, int resolution) { return int(floor(clamp(z, -1.0, float(resolution)))); }

// Whether a column belongs to the map.
bool hasColumn(ivec2 at, int resolution) { return (at.x | at.y) >= 0 && max(at.x, at.y) < resolution; }

// 1 / x, huge in place of infinite: what it is multiplied with may be zero.
float finiteInverse(float x) { return abs(x) > 1e-12 ? 1.0 / x : (x < 0.0 ? -1e12 : 1e12); }
vec3 finiteInverse(vec3 v) { return vec3(finiteInverse(v.x), finiteInverse(v.y), finiteInverse(v.z)); }

// The origin, moved off the surface, in centred cells. A ray that starts on a surface would meet the cells that the surface
// itself occupies: its origin is moved along the normal (ROMA, section 6), and the first `skip` cells along it do not count:
// a ray leaves the surface's cells sideways too, and moving it less far off the surface keeps more of what lies close by.
vec3 occupancyOrigin(OccupancyGrid grid, OccupancySettings settings, Ray ray) {
    return centredCells(grid, ray.origin) + settings.originOffset * ray.normal;
}

// Where the ray begins to count, in cells along it.
float occupancyBegin(OccupancyGrid grid, OccupancySettings settings, Ray ray) {
    float skipped = ray.normal != vec3(0.0) ? settings.skip : 0.0;
    return max(ray.tMin * grid.inverseCellSize, skipped);
}

// How far from where it is reported the surface of a hit may lie, in cells: the least bounds that always hold.
//
// Marked is what the surface touches, so it lies within a cell's diagonal of every point of a marked cell: of a hit there too.
const float markedCellReach = 1.7320508; // sqrt(3)
// A cell of a turned map is occupied if its centre lies in a marked cell; from the centre to a hit in it it is half a diagonal.
const float turnedCellReach = 2.5980762; // 3 / 2 sqrt(3)

// The same in render space. What the ray met from where it was moved to is reported on the ray that was asked for.
float occupancyError(OccupancyGrid grid, OccupancySettings settings, Ray ray, float reach) {
    return (reach + (ray.normal != vec3(0.0) ? settings.originOffset : 0.0)) * grid.cellSize;
}
