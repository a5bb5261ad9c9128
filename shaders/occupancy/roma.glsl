// The module `tracer` by a ray-aligned occupancy map array (ROMA, section 4.2). See shared/roma.h and shared/occupancy.h.
//
// Snapping (the consumer defines REQUESTS_SNAP). The consumer draws a direction w with density cos(n, w) / pi around the
// normal n. aim finds the stratum S that w (or -w) lies in and traces its candidate c instead: S is chosen with
// probability P(S) = integral over S of max(0, n.w) / pi, and c is uniform in S over the frames, since candidates are
// jittered within their strata. With f(S) the mean of max(0, n.w) over S, weight = max(0, n.c) / f(S) gives
//
//     E[weight V(c)] = sum over S of P(S) E[max(0, n.c) V(c)] / f(S) = 1 / pi * integral of max(0, n.w) V(w):
//
// no bias from snapping, for what the map says is visible. Two approximations remain: f(S) is meanCosine() of shared/roma.h
// (under an open sky the result is 1 to 0.5 % from 4 x 4 strata on, whatever the tilt), and weights end at romaMaxWeight.
// Without the weight the estimate is that of the paper: the candidates stand for the rays, and those below the horizon
// darken it. A candidate below the horizon has weight 0 and need not be traced.
//
// Not snapping, the ray goes through the map of its stratum's candidate in a DDA over columns, each tested in one step
// along z; after ITERATIONS columns the ray counts as unoccluded.
//
// A cell occludes if the closed interval [tMin, tMax] of the ray, so moved, meets it; the reported t is the middle of the
// ray's way through the cell, kept within [tMin, tMax].
//
// Algorithm 2 as printed tests signed words (an occupied top cell reads as a miss), shifts by 32, loses half a cell on one
// of the two ways, and transforms the direction like a point; here words are unsigned, masks are built of shifts below
// 32, and directions are rotated only.
#include "lib/iterations.glsl"
#include "occupancy/aligned.glsl"

layout(std140) uniform M(Grid) { OccupancyGrid M(grid); };
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

OccupancyColumn M(column)(int map, ivec2 at) {
    int index = (map * RESOLUTION + at.y) * RESOLUTION + at.x;
#if WORDS == 8
    return columnOf(TEXELS(2 * index), TEXELS(2 * index + 1));
#else
    return columnOf(TEXELS(index));
#endif
}

// The origin, moved off the surface, in the cell coordinates of the map along `axis`.
vec3 M(alignedOrigin)(Ray ray, vec3 axis) {
    return align(occupancyOrigin(M(grid), M(settings)(), ray), axis) + vec3(RESOLUTION / 2);
}

#ifdef REQUESTS_SNAP

// Where a snapped ray goes: one column, and the cells from `first` to `last` in it.
struct M(Way) {
    int map;
    ivec2 at;
    int first;
    int last;
    float z; // of the origin, cells
    bool up;
    bool intersects; // it meets the map
};

M(Way) M(way)(Ray ray) {
    M(Way) way;
    way.map = alignedMap(ray);
    way.up = alignedUp(ray);
    vec3 origin = M(alignedOrigin)(ray, way.up ? ray.direction : -ray.direction);
    float from = occupancyBegin(M(grid), M(settings)(), ray);
    float to = ray.tMax * M(grid).inverseCellSize;
    way.at = ivec2(floor(clamp(origin.xy, vec2(-1.0), vec2(RESOLUTION))));
    way.first = cellAt(way.up ? origin.z + from : origin.z - to, RESOLUTION);
    way.last = cellAt(way.up ? origin.z + to : origin.z - from, RESOLUTION);
    way.z = origin.z;
    way.intersects = hasColumn(way.at, RESOLUTION) && from <= to;
    return way;
}

bool M(anyHit)(Ray ray) {
    M(Way) way = M(way)(ray);
    if (!way.intersects) return false;
    return columnAny(columnPart(M(column)(way.map, way.at), way.first, way.last));
}

bool M(closestHit)(Ray ray, out Hit hit) {
    hit = noHit;
    M(Way) way = M(way)(ray);
    if (!way.intersects) return false;
    int cell = columnFirst(columnPart(M(column)(way.map, way.at), way.first, way.last), way.up);
    if (cell < 0) return false;
    float t = (way.up ? 1.0 : -1.0) * (float(cell) + 0.5 - way.z) * M(grid).cellSize;
    hit.t = clamp(t, ray.tMin, ray.tMax);
    hit.error = occupancyError(M(grid), M(settings)(), ray, turnedCellReach);
    hit.id = uvec2(way.map, cell);
    return true;
}

#else

// The nearest occupied cell in [tMin, tMax]; `nearest` false stops at any. -1 if there is none, and t in cells otherwise.
int M(walk)(Ray ray, bool nearest, out float t) {
    int map = alignedMap(ray);
    vec3 axis = M(candidate)(map).direction;
    t = 0.0;
    ColumnWalk walk = beginWalk(M(alignedOrigin)(ray, axis), align(ray.direction, axis),
                                occupancyBegin(M(grid), M(settings)(), ray), ray.tMax * M(grid).inverseCellSize, RESOLUTION);
    if (!walk.intersects) return -1;
    int cell = -1;
    bool finished = false;
    for (int i = 0; i < ITERATIONS; ++i) {
        ITERATION;
        cell = walkCell(walk, M(column)(map, walk.at), RESOLUTION);
        if (cell >= 0) {
            if (nearest) t = walkMiddle(walk, cell);
            finished = true;
            break;
        }
        if (!walkOn(walk, RESOLUTION)) {
            finished = true;
            break;
        }
    }
#ifdef COUNT_EXHAUSTED
    atomicAdd(M(exhausted)[0], 1u);
    if (!finished) atomicAdd(M(exhausted)[1], 1u);
#endif
    return cell;
}

bool M(anyHit)(Ray ray) {
    float t;
    return M(walk)(ray, false, t) >= 0;
}

bool M(closestHit)(Ray ray, out Hit hit) {
    hit = noHit;
    float t;
    int cell = M(walk)(ray, true, t);
    if (cell < 0) return false;
    hit.t = clamp(t * M(grid).cellSize, ray.tMin, ray.tMax);
    hit.error = occupancyError(M(grid), M(settings)(), ray, turnedCellReach);
    hit.id = uvec2(ray.token & 0xffffu, cell);
    return true;
}

#endif // REQUESTS_SNAP
#endif // EMPTY
#undef TEXELS
