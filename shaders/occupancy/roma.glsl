// The module `tracer` by a ray-aligned occupancy map array (ROMA, section 4.2). See shared/roma.h and shared/occupancy.h.
//
// Snapping (the consumer defines TAKES_SNAP). The consumer draws a direction w with density cos(n, w) / pi around the
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
// A ray that starts on a surface would meet the cells that the surface itself occupies. Its origin is moved along the
// normal (section 6), and the first `skip` cells along it do not count: a ray leaves the surface's cells sideways too, and
// moving it less far off the surface keeps more of what lies close by.
//
// A cell occludes if the closed interval [tMin, tMax] of the ray, so moved, meets it; the reported t is the middle of the
// ray's way through the cell, kept within [tMin, tMax].
//
// Algorithm 2 as printed tests signed words (an occupied top cell reads as a miss), shifts by 32, loses half a cell on one
// of the two ways, and transforms the direction like a point; here words are unsigned, masks are built of shifts below
// 32, and directions are rotated only.
#include "lib/tracer.glsl"
#include "lib/trips.glsl"
#include "shared/occupancy.h"
#include "shared/roma.h"

#if WORDS == 1
#define TEXEL r32ui
#elif WORDS == 2
#define TEXEL rg32ui
#else
#define TEXEL rgba32ui
#endif

layout(std140) uniform M(Grid) { OccupancyGrid M(grid); };
layout(std140) uniform M(Directions) {
    RomaSettings M(settings);
    RomaDirection M(candidates)[DIRECTIONS];
};

#ifdef COUNT_EXHAUSTED
layout(std430) buffer M(Exhausted) { uint M(exhausted)[]; };
#endif

const uint M(flipped) = 0x80000000u; // in the token: the ray goes against the map's z axis

void M(aim)(inout Ray ray) {
    float flip = ray.direction.z < 0.0 ? -1.0 : 1.0;
    int map = stratumOf(flip * ray.direction, ANGULAR);
    ray.token = uint(map) | (flip < 0.0 ? M(flipped) : 0u);
#ifdef TAKES_SNAP
    RomaDirection own = M(candidates)[map];
    ray.direction = flip * own.direction;
    if (ray.normal != vec3(0.0)) ray.weight *= romaWeight(own, flip, ray.direction, ray.normal);
#endif
}

#ifdef EMPTY
bool M(anyHit)(Ray ray) { return false; }
bool M(closestHit)(Ray ray, out Hit hit) {
    hit = Hit(rayInfinity, 0u, uvec2(0u));
    return false;
}
#else

#ifdef MAPS_STORAGE
#if WORDS == 1
layout(std430) readonly buffer M(Maps) { uint M(maps)[]; };
#elif WORDS == 2
layout(std430) readonly buffer M(Maps) { uvec2 M(maps)[]; };
#else
layout(std430) readonly buffer M(Maps) { uvec4 M(maps)[]; };
#endif
#define TEXELS(index) M(maps)[index]
#else
layout(TEXEL) readonly uniform uimageBuffer M(maps);
#define TEXELS(index) imageLoad(M(maps), index)
#endif

// The words of a map's column.
struct M(Column) {
    uint words[WORDS];
};

M(Column) M(column)(int map, ivec2 at) {
    M(Column) column;
    int index = (map * RESOLUTION + at.y) * RESOLUTION + at.x;
#if WORDS == 1
    column.words[0] = TEXELS(index)
#ifndef MAPS_STORAGE
                          .x
#endif
        ;
#elif WORDS == 2
    uvec2 texel = TEXELS(index).xy;
    column.words[0] = texel.x;
    column.words[1] = texel.y;
#else
    for (int i = 0; i < WORDS / 4; ++i) {
        uvec4 texel = TEXELS(WORDS / 4 * index + i);
        column.words[4 * i] = texel.x;
        column.words[4 * i + 1] = texel.y;
        column.words[4 * i + 2] = texel.z;
        column.words[4 * i + 3] = texel.w;
    }
#endif
    return column;
}

bool M(inside)(ivec2 at) { return (at.x | at.y) >= 0 && max(at.x, at.y) < RESOLUTION; }

// The cell that z lies in; -1 below the map and RESOLUTION above it, which columnMask() takes for no cell.
int M(cellAt)(float z) { return int(floor(clamp(z, -1.0, float(RESOLUTION)))); }

// Whether a cell from `first` to `last` is occupied.
bool M(occupied)(M(Column) column, int first, int last) {
    uint found = 0u;
    for (int w = 0; w < WORDS; ++w) found |= column.words[w] & columnMask(first, last, w);
    return found != 0u;
}

// The first occupied cell met going up (or down) from `first` to `last` (or back); -1 if there is none.
int M(firstOccupied)(M(Column) column, int first, int last, bool up) {
    int lowest = -1;
    int highest = -1;
    for (int w = 0; w < WORDS; ++w) {
        uint found = column.words[w] & columnMask(first, last, w);
        if (found == 0u) continue;
        if (lowest < 0) lowest = 32 * w + findLSB(found);
        highest = 32 * w + findMSB(found);
    }
    return up ? lowest : highest;
}

// A vector in the map's axes.
vec3 M(align)(vec3 v, vec3 axis) { return vec3(dot(v, romaAxisX(axis)), dot(v, romaAxisY(axis)), dot(v, axis)); }

// The origin, moved off the surface, in the cell coordinates of the map along `axis`.
vec3 M(alignedOrigin)(Ray ray, vec3 axis) {
    vec3 centred = centredCells(M(grid), ray.origin) + M(settings).originOffset * ray.normal;
    return M(align)(centred, axis) + vec3(RESOLUTION / 2);
}

// Where the ray begins to count, in cells along it.
float M(begin)(Ray ray) {
    float skipped = ray.normal != vec3(0.0) ? M(settings).skip : 0.0;
    return max(ray.tMin * M(grid).inverseCellSize, skipped);
}

#ifdef TAKES_SNAP

// Where a snapped ray goes: one column, and the cells from `first` to `last` in it.
struct M(Way) {
    int map;
    ivec2 at;
    int first;
    int last;
    float z; // of the origin, cells
    bool up;
    bool some; // it meets the map
};

M(Way) M(way)(Ray ray) {
    M(Way) way;
    way.map = int(ray.token & 0xffffu);
    way.up = (ray.token & M(flipped)) == 0u;
    vec3 origin = M(alignedOrigin)(ray, way.up ? ray.direction : -ray.direction);
    float from = M(begin)(ray);
    float to = ray.tMax * M(grid).inverseCellSize;
    way.at = ivec2(floor(clamp(origin.xy, vec2(-1.0), vec2(RESOLUTION))));
    way.first = M(cellAt)(way.up ? origin.z + from : origin.z - to);
    way.last = M(cellAt)(way.up ? origin.z + to : origin.z - from);
    way.z = origin.z;
    way.some = M(inside)(way.at) && from <= to;
    return way;
}

bool M(anyHit)(Ray ray) {
    M(Way) way = M(way)(ray);
    if (!way.some) return false;
    return M(occupied)(M(column)(way.map, way.at), way.first, way.last);
}

bool M(closestHit)(Ray ray, out Hit hit) {
    hit = Hit(rayInfinity, 0u, uvec2(0u));
    M(Way) way = M(way)(ray);
    if (!way.some) return false;
    int cell = M(firstOccupied)(M(column)(way.map, way.at), way.first, way.last, way.up);
    if (cell < 0) return false;
    float t = (way.up ? 1.0 : -1.0) * (float(cell) + 0.5 - way.z) * M(grid).cellSize;
    hit.t = clamp(t, ray.tMin, ray.tMax);
    hit.id = uvec2(way.map, cell);
    return true;
}

#else

// 1 / x, huge in place of infinite: what it is multiplied with may be zero.
float M(inverse)(float x) { return abs(x) > 1e-12 ? 1.0 / x : (x < 0.0 ? -1e12 : 1e12); }

// The nearest occupied cell in [tMin, tMax]; `nearest` false stops at any. -1 if there is none, and t in cells otherwise.
int M(walk)(Ray ray, bool nearest, out float t) {
    int map = int(ray.token & 0xffffu);
    vec3 axis = M(candidates)[map].direction;
    vec3 origin = M(alignedOrigin)(ray, axis);
    vec3 direction = M(align)(ray.direction, axis);
    vec3 inverse = vec3(M(inverse)(direction.x), M(inverse)(direction.y), M(inverse)(direction.z));
    t = 0.0;

    // The part of the ray inside the map.
    vec3 low = -origin * inverse;
    vec3 high = (vec3(RESOLUTION) - origin) * inverse;
    vec3 nearer = min(low, high);
    vec3 farther = max(low, high);
    float from = max(M(begin)(ray), max(nearer.x, max(nearer.y, nearer.z)));
    float to = min(ray.tMax * M(grid).inverseCellSize, min(farther.x, min(farther.y, farther.z)));
    if (!(from <= to)) return -1;

    ivec2 at = clamp(ivec2(floor(origin.xy + from * direction.xy)), ivec2(0), ivec2(RESOLUTION - 1));
    ivec2 onward = ivec2(direction.x < 0.0 ? -1 : 1, direction.y < 0.0 ? -1 : 1);
    vec2 leave = (vec2(at + max(onward, ivec2(0))) - origin.xy) * inverse.xy; // where the column ends, along x and y
    vec2 across = abs(inverse.xy);
    int cell = -1;
    bool finished = false;
    for (int i = 0; i < ITERATIONS; ++i) {
        TRIP;
        float end = min(to, min(leave.x, leave.y));
        float z0 = origin.z + from * direction.z;
        float z1 = origin.z + end * direction.z;
        int first = M(cellAt)(min(z0, z1));
        int last = M(cellAt)(max(z0, z1));
        M(Column) column = M(column)(map, at);
        cell = M(firstOccupied)(column, first, last, direction.z >= 0.0);
        if (cell >= 0) {
            if (nearest) {
                float a = (float(cell) - origin.z) * inverse.z;
                float b = (float(cell + 1) - origin.z) * inverse.z;
                t = 0.5 * (clamp(min(a, b), from, end) + clamp(max(a, b), from, end));
            }
            finished = true;
            break;
        }
        bvec2 next = bvec2(leave.x <= leave.y, leave.x > leave.y);
        at += onward * ivec2(next);
        leave += across * vec2(next);
        from = end;
        if (end >= to || !M(inside)(at)) {
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
    hit = Hit(rayInfinity, 0u, uvec2(0u));
    float t;
    int cell = M(walk)(ray, true, t);
    if (cell < 0) return false;
    hit.t = clamp(t * M(grid).cellSize, ray.tMin, ray.tMax);
    hit.id = uvec2(ray.token & 0xffffu, cell);
    return true;
}

#endif // TAKES_SNAP
#endif // EMPTY
#undef TEXEL
#undef TEXELS
