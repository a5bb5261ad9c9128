// The module `tracer` by nested ray-aligned occupancy map arrays (ROMA, section 7.2, "scalability"): LEVELS of them with the
// same candidate directions, the finest first, each around the camera, the coarsest around the scene. See
// occupancy/roma.glsl for how rays are aimed and snapped.
//
// However a level's cube is turned, it contains the sphere that touches its faces. A level answers for the ray's way through
// its sphere, but for what lies in the sphere of the next finer level, whose answer is the better one; the coarsest answers
// for all that is left. So each stretch of the ray is looked up in the finest map that has it, and a level has two stretches
// at most: before the finer sphere and beyond it. Where both end a cell is looked up by either.
//
// Offset and skip are those of each level's own cells: a coarse cell of the surface that the ray left must not occlude it.
#include "lib/iterations.glsl"
#include "occupancy/aligned.glsl"

layout(std140) uniform M(Grids) { OccupancyGrid M(grids)[LEVELS]; };
#include <part:occupancy/aim.glsl>

#ifdef EMPTY
#include <part:lib/no_hits.glsl>
#else

#ifdef MAPS_STORAGE
layout(std430) readonly buffer M(Maps) { COLUMN_TYPE M(maps)[]; };
#define TEXELS(index) M(maps)[index]
#else
layout(COLUMN_FORMAT) readonly uniform uimageBuffer M(maps);
#define TEXELS(index) imageLoad(M(maps), index).COLUMN_PART
#endif

OccupancyColumn M(column)(int level, int map, ivec2 at) {
    int index = ((level * DIRECTIONS + map) * RESOLUTION + at.y) * RESOLUTION + at.x;
#if WORDS == 8
    return columnOf(TEXELS(2 * index), TEXELS(2 * index + 1));
#else
    return columnOf(TEXELS(index));
#endif
}

const float M(nowhere) = 1e30; // begins and ends stretches that are empty

// The ray's way through a level's sphere, render space: where it enters and where it leaves. The sphere ends a cell before
// the map: cells of a turned map that it cuts have their centres within the cube.
vec2 M(throughSphere)(Ray ray, OccupancyGrid grid) {
    vec3 origin = centredCells(grid, ray.origin);
    float radius = float(RESOLUTION / 2 - 1);
    float nearest = -dot(origin, ray.direction);
    vec3 aside = origin + nearest * ray.direction;
    float under = radius * radius - dot(aside, aside);
    if (under <= 0.0) return vec2(M(nowhere), -M(nowhere));
    return (nearest + vec2(-sqrt(under), sqrt(under))) * grid.cellSize;
}

// The stretches of the ray that a level answers for, in its cells: (xy) before the finer level's sphere, (zw) beyond it.
// `finer` is the ray's way through the finer sphere; entering after leaving: it misses it.
vec4 M(stretches)(Ray ray, int level, OccupancyGrid grid, vec2 own, vec2 finer) {
    float from = occupancyBegin(grid, M(settings)(), ray);
    float to = ray.tMax * grid.inverseCellSize;
    if (level < LEVELS - 1) {
        from = max(from, own.x * grid.inverseCellSize);
        to = min(to, own.y * grid.inverseCellSize);
    }
    if (finer.x > finer.y) return vec4(from, to, M(nowhere), -M(nowhere));
    finer *= grid.inverseCellSize;
    return vec4(from, min(to, finer.x), max(from, finer.y), to);
}

// The origin, moved off the surface, in the cell coordinates of a level's map along `axis`.
vec3 M(alignedOrigin)(Ray ray, OccupancyGrid grid, vec3 axis) {
    return align(occupancyOrigin(grid, M(settings)(), ray), axis) + vec3(RESOLUTION / 2);
}

#ifdef REQUESTS_SNAP

// The part of a column that the ray passes on a stretch of it.
OccupancyColumn M(stretchOf)(OccupancyColumn column, float z, bool up, vec2 stretch) {
    int first = cellAt(up ? z + stretch.x : z - stretch.y, RESOLUTION);
    int last = cellAt(up ? z + stretch.y : z - stretch.x, RESOLUTION);
    return columnPart(column, stretch.x <= stretch.y ? first : 1, stretch.x <= stretch.y ? last : 0);
}

// The first occupied cell of a level: how far along the ray in render space; M(nowhere) if there is none.
float M(find)(Ray ray, int level, OccupancyGrid grid, vec2 own, vec2 finer, out int cell) {
    bool up = alignedUp(ray);
    vec3 origin = M(alignedOrigin)(ray, grid, up ? ray.direction : -ray.direction);
    ivec2 at = ivec2(floor(clamp(origin.xy, vec2(-1.0), vec2(RESOLUTION))));
    vec4 stretches = M(stretches)(ray, level, grid, own, finer);
    OccupancyColumn column = M(column)(level, alignedMap(ray), at);
    OccupancyColumn before = M(stretchOf)(column, origin.z, up, stretches.xy);
    OccupancyColumn beyond = M(stretchOf)(column, origin.z, up, stretches.zw);
    column = OccupancyColumn(before.low | beyond.low, before.high | beyond.high);
    cell = hasColumn(at, RESOLUTION) ? columnFirst(column, up) : -1;
    return cell < 0 ? M(nowhere) : (up ? 1.0 : -1.0) * (float(cell) + 0.5 - origin.z) * grid.cellSize;
}

#else

float M(find)(Ray ray, int level, OccupancyGrid grid, vec2 own, vec2 finer, out int cell) {
    int map = alignedMap(ray);
    vec3 axis = M(candidate)(map).direction;
    vec3 origin = M(alignedOrigin)(ray, grid, axis);
    vec3 direction = align(ray.direction, axis);
    vec4 stretches = M(stretches)(ray, level, grid, own, finer);
    float t = M(nowhere);
    cell = -1;
    bool finished = true;
    for (int part = 0; part < 2; ++part) {
        ITERATION;
        vec2 stretch = part == 0 ? stretches.xy : stretches.zw;
        ColumnWalk walk = beginWalk(origin, direction, stretch.x, stretch.y, RESOLUTION);
        if (cell >= 0 || !walk.intersects) continue;
        finished = false;
        for (int i = 0; i < ITERATIONS; ++i) {
            ITERATION;
            cell = walkCell(walk, M(column)(level, map, walk.at), RESOLUTION);
            if (cell >= 0) t = walkMiddle(walk, cell) * grid.cellSize;
            if (cell >= 0 || !walkOn(walk, RESOLUTION)) {
                finished = true;
                break;
            }
        }
        if (!finished) break;
    }
#ifdef COUNT_EXHAUSTED
    if (!finished) atomicAdd(M(exhausted)[1], 1u);
#endif
    return t;
}

#endif

// The nearest occupied cell of all levels; the first that any level finds if any will do.
bool M(search)(Ray ray, bool nearest, out Hit hit) {
    hit = noHit;
    vec2 finer = vec2(M(nowhere), -M(nowhere));
    float best = M(nowhere);
    for (int level = 0; level < LEVELS; ++level) {
        ITERATION;
        OccupancyGrid grid = M(grids)[level];
        vec2 own = M(throughSphere)(ray, grid);
        int cell;
        float t = M(find)(ray, level, grid, own, finer, cell);
        if (cell >= 0 && t < best) {
            best = t;
            hit.error = occupancyError(grid, M(settings)(), ray, turnedCellReach);
            hit.id = uvec2(level * DIRECTIONS + alignedMap(ray), cell);
        }
        if (cell >= 0 && !nearest) break;
        finer = own;
    }
#ifdef COUNT_EXHAUSTED
    atomicAdd(M(exhausted)[0], 1u);
#endif
    if (best >= M(nowhere)) return false;
    hit.t = clamp(best, ray.tMin, ray.tMax);
    return true;
}

bool M(anyHit)(Ray ray) {
    Hit hit;
    return M(search)(ray, false, hit);
}

bool M(closestHit)(Ray ray, out Hit hit) { return M(search)(ray, true, hit); }

#endif // EMPTY
#undef TEXELS
