// Finds which pixels each triangle touches in each view of the A-buffer, and keeps a record of it there. By its
// defines:
//
//     (none)  an invocation a triangle and view: few pixels are looked at here, more are listed as blocks
//     BLOCKS  an invocation a listed block of 64 x 64 pixels: lists its tiles
//     TILES   an invocation a listed tile of 8 x 8 pixels
//             Each gives `candidates`: pixel, depths, triangle; and the pixel's bounds.
//     COUNT   an invocation a candidate: counts in the buckets that it meets
//     SCATTER the same: its number into each of them, in no order
//     RANK    the same: a record at the place that its order in the bucket says
#include "lib/iterations.glsl"
#include "lib/scene.glsl"
#include "shared/work_list.h"
#include "abuffer/lists.glsl"
#include "abuffer/primitive_lists.glsl"
#include "abuffer/primitive_cover.glsl"

layout(local_size_x = 64) in;

layout(r32ui) uniform uimageBuffer cells;
layout(std430) buffer CandidateCount { uint candidate_count; };

// Elements that there is room for.
#ifndef BLOCKS
uniform uint candidates_room;
#endif

#if defined(COUNT) || defined(SCATTER) || defined(RANK)

layout(rgba32ui) uniform readonly uimageBuffer candidates;
#ifdef SCATTER
layout(r32ui) uniform writeonly uimageBuffer order;
uniform uint order_room;
#endif
#ifdef RANK
layout(r32ui) uniform readonly uimageBuffer order;
layout(rgba32ui) uniform writeonly uimageBuffer records;
uniform uint records_room;
#endif

void main() {
    uint index = gl_GlobalInvocationID.y * uint(ROW) + gl_GlobalInvocationID.x;
    if (index >= min(candidate_count, candidates_room)) return;
    uvec4 own = imageLoad(candidates, int(index));
    float zMin = uintBitsToFloat(imageLoad(cells, int(own.x) * PRIMITIVE_WORDS).r);
    float zMax = uintBitsToFloat(imageLoad(cells, int(own.x) * PRIMITIVE_WORDS + 1).r);
#ifdef COUNT
    zMin = uintBitsToFloat(~floatBitsToUint(zMin)); // kept as its complement, of which the largest is had
#endif
    uint first = abufferBucket(uintBitsToFloat(own.y), zMin, zMax, uint(BUCKETS));
    uint last = abufferBucket(uintBitsToFloat(own.z), zMin, zMax, uint(BUCKETS));
    for (uint bucket = first; bucket <= last; ++bucket) {
        ITERATION;
#if defined(COUNT)
        imageAtomicAdd(cells, PRIMITIVE_BEGIN(own.x, bucket + 1u), 1u);
#elif defined(SCATTER)
        // Counts from where the bucket begins to where it ends, which is where the next begins.
        uint at = imageAtomicAdd(cells, PRIMITIVE_BEGIN(own.x, bucket + 1u), 1u);
        if (at < order_room) imageStore(order, int(at), uvec4(index));
#else
        uint begin = imageLoad(cells, PRIMITIVE_BEGIN(own.x, bucket)).r;
        uint end = min(imageLoad(cells, PRIMITIVE_BEGIN(own.x, bucket + 1u)).r, records_room);
        uint before = 0u;
        for (uint i = begin; i < end; ++i) {
            ITERATION;
            uvec4 other = imageLoad(candidates, int(imageLoad(order, int(i)).r));
            // Depths are not negative: their bits have their order.
            before += other.y < own.y || (other.y == own.y && other.w < own.w) ? 1u : 0u;
        }
        if (begin + before < records_room) imageStore(records, int(begin + before), uvec4(own.yzw, first));
#endif
    }
    ITERATIONS_END;
}

#else

layout(std140) uniform CellsView { ViewData cellsView; };
#if !defined(BLOCKS)
layout(rgba32ui) uniform writeonly uimageBuffer candidates;
#endif
#if !defined(BLOCKS) && !defined(TILES)
uniform uint triangleCount;
#endif
#ifndef TILES
layout(std430) buffer Blocks {
    WorkListHeader header;
    uvec2 items[];
} blocks;
uniform uint blocks_room;
#endif
#if defined(BLOCKS) || defined(TILES)
layout(std430) buffer Tiles {
    WorkListHeader header;
    uvec2 items[];
} tiles;
uniform uint tiles_room;
#endif

const uint listRow = 32768u; // work groups in a row of a list's dispatch
const int blockShift = 6;
const int tileShift = 3;

// An item: the triangle, and its view with the block or tile, none of which has more than 13 bits an axis.
uvec2 packItem(uint triangle, uint view, ivec2 at) { return uvec2(triangle, view << 26u | uint(at.y) << 13u | uint(at.x)); }
uint viewOf(uvec2 item) { return item.y >> 26u; }
ivec2 placeOf(uvec2 item) { return ivec2(item.y & 8191u, (item.y >> 13u) & 8191u); }

// This invocation's item of a list.
uint itemIndex() { return gl_GlobalInvocationID.y * (listRow * workListGroup) + gl_GlobalInvocationID.x; }

#if defined(TILES) || !defined(BLOCKS)

// Keeps the pixels of a box of 64 pixels at most that the triangle touches.
void keep(CoveredTriangle covered, uint triangle, uint view, ivec2 first, ivec2 last) {
    ivec2 extent = max(last - first + 1, ivec2(0));
    int pixels = extent.x * extent.y;
    vec2 size = vec2(abufferSize(cellsView, ABUFFER_SHAPE, view));
    uvec2 mask = uvec2(0u);
    for (int i = 0; i < pixels; ++i) {
        ITERATION;
        vec2 depths;
        uint bit = covers(covered, size, first + ivec2(i % extent.x, i / extent.x), 1.0, depths) ? 1u << uint(i & 31) : 0u;
        if (i < 32) {
            mask.x |= bit;
        } else {
            mask.y |= bit;
        }
    }
    uint count = uint(bitCount(mask.x) + bitCount(mask.y));
    if (count == 0u) return;
    // One address for all: the counter that everybody contends for is had once.
    uint at = atomicAdd(candidate_count, count);
    for (uint k = 0u; k < count; ++k) {
        ITERATION;
        int i = mask.x != 0u ? findLSB(mask.x) : 32 + findLSB(mask.y);
        if (mask.x != 0u) {
            mask.x &= mask.x - 1u;
        } else {
            mask.y &= mask.y - 1u;
        }
        ivec2 pixel = first + ivec2(i % extent.x, i / extent.x);
        vec2 depths;
        covers(covered, size, pixel, 1.0, depths);
        uvec2 bits = floatBitsToUint(depths);
        int cell = ABUFFER_PIXEL(view, pixel);
        imageAtomicMax(cells, cell * PRIMITIVE_WORDS, ~bits.x);
        imageAtomicMax(cells, cell * PRIMITIVE_WORDS + 1, bits.y);
        if (at + k < candidates_room) imageStore(candidates, int(at + k), uvec4(uint(cell), bits, triangle));
    }
}

#endif

CoveredTriangle coveredOf(uint triangle, uint view) {
    uvec4 corners = sceneTriangle(triangle);
    return coveredTriangle(cellsView, ABUFFER_SHAPE, view, scenePosition(corners.x), scenePosition(corners.y),
                           scenePosition(corners.z));
}

#ifdef TILES

void main() {
    if (itemIndex() >= min(tiles.header.count, tiles_room)) return;
    uvec2 item = tiles.items[itemIndex()];
    ivec2 first = placeOf(item) << tileShift;
    CoveredTriangle covered = coveredOf(item.x, viewOf(item));
    keep(covered, item.x, viewOf(item), max(first, covered.first), min(first + (1 << tileShift) - 1, covered.last));
    ITERATIONS_END;
}

#else

// Lists the squares of 2^shift pixels in a box that the triangle touches.
#ifdef BLOCKS
#define LIST tiles
#define ROOM tiles_room
const int shift = tileShift;
#else
#define LIST blocks
#define ROOM blocks_room
const int shift = blockShift;
#endif
void list(CoveredTriangle covered, uint triangle, uint view, ivec2 first, ivec2 last) {
    vec2 size = vec2(abufferSize(cellsView, ABUFFER_SHAPE, view));
    first >>= shift;
    ivec2 extent = max((last >> shift) - first + 1, ivec2(0));
    for (int i = 0; i < extent.x * extent.y; ++i) {
        ITERATION;
        ivec2 at = first + ivec2(i % extent.x, i / extent.x);
        vec2 depths;
        if (!covers(covered, size, at << shift, float(1 << shift), depths)) continue;
        uint place = atomicAdd(LIST.header.count, 1u);
        if (place < ROOM) LIST.items[place] = packItem(triangle, view, at);
        uint group = min(place, ROOM - 1u) / workListGroup;
        atomicMax(LIST.header.groups.x, min(group + 1u, listRow));
        atomicMax(LIST.header.groups.y, group / listRow + 1u);
        LIST.header.groups.z = 1u;
    }
}

void main() {
#ifdef BLOCKS
    if (itemIndex() >= min(blocks.header.count, blocks_room)) return;
    uvec2 item = blocks.items[itemIndex()];
    ivec2 first = placeOf(item) << blockShift;
    CoveredTriangle covered = coveredOf(item.x, viewOf(item));
    list(covered, item.x, viewOf(item), max(first, covered.first), min(first + (1 << blockShift) - 1, covered.last));
#else
    uint triangle = gl_GlobalInvocationID.y * uint(ROW) + gl_GlobalInvocationID.x;
    uint view = uint(FIRST_VIEW) + gl_GlobalInvocationID.z;
    if (gl_GlobalInvocationID.x >= uint(ROW) || triangle >= triangleCount) return;
    CoveredTriangle covered = coveredOf(triangle, view);
    ivec2 extent = max(covered.last - covered.first + 1, ivec2(0));
    bool few = extent.x * extent.y <= FEW;
    // The box of what the other branch does is empty.
    keep(covered, triangle, view, covered.first, few ? covered.last : covered.first - 1);
    list(covered, triangle, view, covered.first, few ? covered.first - (1 << blockShift) : covered.last);
#endif
    ITERATIONS_END;
}

#endif

#endif
