// The module `tracer` by walking through the base occupancy map (the rivals of ROMA, its section 7). METHOD is
//   0: from cell to cell (3D DDA; Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", 1987),
//   1: from column to column, the cells of a column that the ray passes tested 32 at once with a mask of bits along z (2D
//      DDA; Thiedemann et al., "Voxel-based Global Illumination", 2011); a word a step measures a sixth faster on a CPU
//      driver than all words of the column,
//   2: from column to column over a hierarchy: a column of a coarser level is the union of 2 x 2 columns; empty ones are left
//      at once. Here a step tests the whole column, one texel up to 128 cells: a coarse column is passed over many cells,
//   3: from brick of 2 x 2 x 2 cells to brick, and over empty cubes of them (occupancy/brick_walk.glsl).
//
// Rays are mirrored so that they go up along every axis. All methods visit the same cells
// in the same order, to the bit: a plane between cells is passed at the time
//
//     (plane - origin) * inverse direction,
//
// always computed like this and never summed up; the cell at a time follows from comparing such times (cellAtTime), and
// where planes are passed at one time, the one along z comes first, then x, then y. Cells that the ray touches at an edge
// only may be among them. What a walk finds cannot depend on how it got there.
//
// A cell occludes if the closed interval [tMin, tMax] of the ray meets it, see occupancyOrigin() and occupancyBegin() of
// lib/occupancy.glsl for where it begins; the reported t is the middle of the ray's way through the cell, kept within
// [tMin, tMax]. After ITERATIONS cells, words or columns (of any level) the ray counts as unoccluded.
#include "lib/occupancy.glsl"
#include "lib/iterations.glsl"

layout(std140) uniform M(Grid) { OccupancyGrid M(grid); };
layout(std140) uniform M(Settings) { OccupancySettings M(settings); };

#ifdef COUNT_EXHAUSTED
layout(std430) buffer M(Exhausted) { uint M(exhausted)[]; };
#endif

void M(aim)(inout Ray ray) {}

#ifdef EMPTY
#include <part:lib/no_hits.glsl>
#else

#if METHOD < 2

#ifdef MAP_STORAGE
layout(std430) readonly buffer M(Occupancy) { uint M(occupancy)[]; };
#define MAP_WORD(index) M(occupancy)[index]
#else
layout(r32ui) readonly uniform uimageBuffer M(occupancy);
#define MAP_WORD(index) imageLoad(M(occupancy), index).x
#endif

#elif METHOD == 2

#ifdef MAP_STORAGE
layout(std430) readonly buffer M(Columns) { COLUMN_TYPE M(columns)[]; };
#define TEXELS(index) M(columns)[index]
#else
layout(COLUMN_FORMAT) readonly uniform uimageBuffer M(columns);
#define TEXELS(index) imageLoad(M(columns), index).COLUMN_PART
#endif

// Of a level's map, at (x, y) in its columns.
OccupancyColumn M(column)(ivec2 at, int level) {
    int index = occupancyLevelStart(level, RESOLUTION) + at.y * (RESOLUTION >> level) + at.x;
#if WORDS == 8
    return columnOf(TEXELS(2 * index), TEXELS(2 * index + 1));
#else
    return columnOf(TEXELS(index));
#endif
}

#else

#ifdef MAP_STORAGE
layout(std430) readonly buffer M(Bricks) { uint M(bricks)[]; };
#define MAP_WORD(index) M(bricks)[index]
#else
layout(r32ui) readonly uniform uimageBuffer M(bricks);
#define MAP_WORD(index) imageLoad(M(bricks), index).x
#endif

#endif // METHOD

// The part of a ray that counts and lies within the map, in cells, mirrored. Its origin is where it begins: a ray may come
// from far away, and times are exact only where they are small.
struct M(Line) {
    vec3 origin;
    vec3 direction; // not negative
    vec3 inverse;
    ivec3 flip;  // exclusive or with it takes a cell to its mirror image, along the axes that the ray goes down
    float start; // where the line begins along the ray
    float to;    // where it ends, from there
    bool intersects;
#if METHOD == 3
    // Of a brick's index and of a cell's place in it what `flip` is of a cell; and the bit where the ray's codes begin.
    int flipIndex;
    int flipPlace;
    int way;
#endif
};

M(Line) M(line)(Ray ray) {
    M(Line) line;
    bvec3 down = lessThan(ray.direction, vec3(0.0));
    vec3 centred = occupancyOrigin(M(grid), M(settings), ray);
    vec3 origin = mix(centred, -centred, down) + vec3(RESOLUTION / 2);
    line.flip = (RESOLUTION - 1) * ivec3(down);
    line.direction = abs(ray.direction);
    line.inverse = finiteInverse(line.direction);
    vec3 nearer = -origin * line.inverse;
    vec3 farther = (vec3(RESOLUTION) - origin) * line.inverse;
    float from = max(occupancyBegin(M(grid), M(settings), ray), max(nearer.x, max(nearer.y, nearer.z)));
    float to = min(ray.tMax * M(grid).inverseCellSize, min(farther.x, min(farther.y, farther.z)));
    line.intersects = from <= to;
    line.start = line.intersects ? from : 0.0;
    line.to = line.intersects ? to - from : -1.0;
#if METHOD == 3
    ivec3 flipBrick = line.flip >> 1;
    line.flipIndex = flipBrick.y << (2 * BRICK_BITS) | flipBrick.x << BRICK_BITS | flipBrick.z;
    line.flipPlace = int(down.x) | int(down.y) << 1 | int(down.z) << 2;
    line.way = 8 + 3 * line.flipPlace;
#endif
    line.origin = clamp(origin + line.start * line.direction, vec3(0.0), vec3(RESOLUTION));
    return line;
}

#if METHOD != 0

// The cell along one axis once all planes up to `time` (within the line) have been passed, those at that very time too if
// `inclusive`; `last` is an earlier one. The guess is never past it, and short of it by one cell at most: rounding is far
// below its reserve.
int M(cellAtTime)(float origin, float direction, float inverse, int last, float time, bool inclusive) {
    int cell = max(int(origin + time * direction - 1e-3), last);
    float left = (float(cell + 1) - origin) * inverse;
    return cell + int(inclusive ? left <= time : left < time);
}

#endif

#if METHOD == 1

// The cells from `first` to `last` along z, mirrored, of a column; both lie in one word.
uint M(cells)(M(Line) line, ivec2 at, int first, int last) {
    int a = first ^ line.flip.z;
    int b = last ^ line.flip.z;
    ivec2 real = at ^ line.flip.xy;
    uint word = MAP_WORD(occupancyWord(real.x, real.y, a, RESOLUTION));
    return word & (0xffffffffu << uint(min(a, b) & 31)) & ~(0xfffffffeu << uint(max(a, b) & 31));
}

#elif METHOD == 2

// The cells from `first` to `last` along z, mirrored, of a column of a level. No cell lies beyond the map.
OccupancyColumn M(cells)(M(Line) line, ivec2 block, int level, int first, int last) {
    int a = first ^ line.flip.z;
    int b = min(last, RESOLUTION - 1) ^ line.flip.z;
    return columnPart(M(column)(block ^ (line.flip.xy >> level), level), min(a, b), max(a, b));
}

#endif

#if METHOD == 3
#include <part:occupancy/brick_walk.glsl>
#endif

// The first occupied cell of the line, mirrored; false if there is none.
bool M(walk)(M(Line) line, out ivec3 cell) {
    ivec3 at = min(ivec3(line.origin), ivec3(RESOLUTION - 1));
    int last = at.z; // a step tests the cells from at.z to `last`
    int level = 0;
    bool found = false;
    bool finished = !line.intersects;
    if (line.intersects) {
        for (int i = 0; i < ITERATIONS; ++i) {
            ITERATION;
#if METHOD == 0
            ivec3 real = at ^ line.flip;
            uint word = MAP_WORD(occupancyWord(real.x, real.y, real.z, RESOLUTION));
            found = (word >> uint(real.z & 31) & 1u) != 0u;
            vec3 next = (vec3(at + 1) - line.origin) * line.inverse;
            float leave = min(next.z, min(next.x, next.y));
            bool alongZ = next.z <= leave;
            bool alongX = next.x <= leave && !alongZ;
            ivec3 onward = at + ivec3(alongX, !alongX && !alongZ, alongZ);
#elif METHOD == 1
            vec2 next = (vec2(at.xy + 1) - line.origin.xy) * line.inverse.xy;
            float leave = min(next.x, next.y);
            float end = min(leave, line.to);
            last = M(cellAtTime)(line.origin.z, line.direction.z, line.inverse.z, at.z, end, true);
            bool more = last > (at.z | 31); // words of this column
            last = min(last, at.z | 31);
            found = M(cells)(line, at.xy, at.z, last) != 0u;
            bool alongX = next.x <= next.y;
            ivec3 onward = ivec3(at.xy + ivec2(!more && alongX, !more && !alongX), last + int(more));
            leave = more ? 0.0 : leave;
#elif METHOD == 2
            ivec2 block = at.xy >> level;
            ivec2 planes = (block + 1) << level;
            vec2 next = (vec2(planes) - line.origin.xy) * line.inverse.xy;
            float leave = min(next.x, next.y);
            float end = min(leave, line.to);
            last = M(cellAtTime)(line.origin.z, line.direction.z, line.inverse.z, at.z, end, true);
            found = columnAny(M(cells)(line, block, level, at.z, last));
            if (found && level > 0) {
                --level;
                found = false;
                continue;
            }
            // Where the block is left, if the ray goes on. Of planes passed at one time, those along x come before y.
            bool alongX = next.x <= next.y;
            int x = M(cellAtTime)(line.origin.x, line.direction.x, line.inverse.x, at.x, end, true);
            int y = M(cellAtTime)(line.origin.y, line.direction.y, line.inverse.y, at.y, end, false);
            ivec3 onward = ivec3(alongX ? planes.x : x, alongX ? y : planes.y, last);
            // Up where the block's parent is left too.
            ivec2 changed = (onward.xy >> level) ^ block;
            int coarser = min(level + int((changed.x | changed.y) > 1), TOP_LEVEL);
            level = found ? level : coarser;
#else
            ivec3 onward;
            float leave = M(brickStep)(line, at, found, onward);
#endif
            // Cells of the map are smaller than RESOLUTION, a power of two.
            bool outside = (onward.x | onward.y | onward.z) >= RESOLUTION;
            if (found || leave > line.to || outside) {
                finished = true;
                break;
            }
            at = onward;
        }
    }
#ifdef COUNT_EXHAUSTED
    atomicAdd(M(exhausted)[0], 1u);
    if (!finished) atomicAdd(M(exhausted)[1], 1u);
#endif
#if METHOD == 1
    uint bits = M(cells)(line, at.xy, at.z, last);
    at.z = (at.z & ~31) + (line.flip.z == 0 ? findLSB(bits) : 31 - findMSB(bits));
#elif METHOD == 2
    at.z = columnFirst(M(cells)(line, at.xy, 0, at.z, last), line.flip.z == 0) ^ line.flip.z;
#endif
    cell = at;
    return found;
}

bool M(anyHit)(Ray ray) {
    ivec3 cell;
    return M(walk)(M(line)(ray), cell);
}

#ifdef REQUESTS_MANY
#include <part:occupancy/brick_rays.glsl>
#endif

bool M(closestHit)(Ray ray, out Hit hit) {
    hit = noHit;
    M(Line) line = M(line)(ray);
    ivec3 cell;
    if (!M(walk)(line, cell)) return false;
    vec3 nearer = (vec3(cell) - line.origin) * line.inverse;
    vec3 farther = (vec3(cell + 1) - line.origin) * line.inverse;
    float enter = clamp(max(nearer.x, max(nearer.y, nearer.z)), 0.0, line.to);
    float leave = clamp(min(farther.x, min(farther.y, farther.z)), enter, line.to);
    hit.t = clamp((line.start + 0.5 * (enter + leave)) * M(grid).cellSize, ray.tMin, ray.tMax);
    hit.error = occupancyError(M(grid), M(settings), ray, markedCellReach);
    ivec3 real = cell ^ line.flip;
    hit.id = uvec2(uint(real.x | real.y << 8 | real.z << 16), 0u);
    return true;
}

#endif // EMPTY
#undef MAP_WORD
#undef TEXELS
