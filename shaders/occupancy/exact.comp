// Marks every cell that a triangle meets, and no other, or with SEPARATING those that it passes in the columns whose middles
// meet it (shared/triangle_cell.h). Two steps, so that no invocation walks far: one invocation a triangle marks the small ones
// and lists the large ones; with LARGE, `largeSlices` work groups share the columns of a listed triangle.
//
// Triangles with an alpha test occupy a cell where the test passes at the point of the triangle over the cell's centre.
#include "lib/iterations.glsl"
#include "lib/scene.glsl"
#include "shared/occupancy.h"
#include "shared/triangle_cell.h"

layout(local_size_x = 8, local_size_y = 8) in;

#ifdef LEVELS
// Several maps one after the other; this step marks one of them.
layout(std140) uniform Grids { OccupancyGrid grids[LEVELS]; };
uniform int level;
#define GRID grids[level]
#define FIRST_WORD (level * (RESOLUTION * RESOLUTION * RESOLUTION / 32))
#else
layout(std140) uniform Grid { OccupancyGrid grid; };
#define GRID grid
#define FIRST_WORD 0
#endif
layout(std430) buffer Occupancy { uint occupancy[]; };
// The work groups of the second step (an indirect command), how many triangles are large, and which.
layout(std430) buffer Large {
    uint groupsX;
    uint groupsY;
    uint groupsZ;
    uint count;
    uint triangles[];
} large;

uniform int triangleCount;
#ifdef SEPARATING
// Cells that one-sided surfaces are moved back, and where triangles begin that are double-sided, masked, and both.
uniform float inset;
uniform ivec3 classes;
#endif

const uint largeSlices = 16u;
const uint maxGroups = 65535u;
// More columns than this in the bounding box make a triangle large. Each takes up to RESOLUTION + 1 iterations.
const int smallColumns = 64;

// Weights of the triangle's second and third corner where its plane is over the cell's centre, kept inside it.
vec2 weightsOver(vec3 a, vec3 b, vec3 c) {
    vec3 ab = b - a;
    vec3 ac = c - a;
    vec3 normal = cross(ab, ac);
    float area = dot(normal, normal);
    if (area == 0.0) return vec2(1.0 / 3.0);
    vec2 w = vec2(dot(cross(-a, ac), normal), dot(cross(ab, -a), normal)) / area;
    w = max(w, vec2(0.0));
    return w / max(1.0, w.x + w.y);
}

struct Corners {
    vec3 a;
    vec3 b;
    vec3 c;
};

Corners cornersOf(uint triangle) {
    uvec4 vertices = sceneTriangle(triangle);
    Corners corners = Corners(cellsOf(GRID, scenePosition(vertices.x)), cellsOf(GRID, scenePosition(vertices.y)),
                              cellsOf(GRID, scenePosition(vertices.z)));
#ifdef SEPARATING
    int index = int(triangle);
    bool oneSided = index < classes.x || (index >= classes.y && index < classes.z);
    vec3 back = oneSided ? behindFace(corners.a, corners.b, corners.c, inset) : vec3(0.0);
    corners = Corners(corners.a + back, corners.b + back, corners.c + back);
#endif
    return corners;
}

void markColumn(uint triangle, Corners corners, TriangleWalk walk, int x, int y) {
#ifdef SEPARATING
    if (!columnMeets(walk, corners.a, corners.b, corners.c, x, y)) return;
    ivec2 range = throughColumn(walk, x, y);
#else
    ivec2 range = walkColumn(walk, x, y);
#endif
    for (int z = range.x; z <= range.y; ++z) {
        ITERATION;
        ivec3 cell = axisBack(ivec3(x, y, z), walk.axis);
        vec3 centre = vec3(cell) + 0.5;
        vec3 a = corners.a - centre;
        vec3 b = corners.b - centre;
        vec3 c = corners.c - centre;
#ifndef SEPARATING
        if (!triangleMeetsCube(a, b, c)) continue;
#endif
#ifdef MATERIAL_MASKED
        if (!sceneCovers(triangle, weightsOver(a, b, c))) continue;
#endif
        int word = FIRST_WORD + occupancyWord(cell.x, cell.y, cell.z, RESOLUTION);
        atomicOr(occupancy[word], 1u << uint(cell.z & 31));
    }
}

#ifdef LARGE

void main() {
    uint index = gl_WorkGroupID.z * maxGroups + gl_WorkGroupID.y;
    if (index >= large.count) return;
    uint triangle = large.triangles[index];
    Corners corners = cornersOf(triangle);
    TriangleWalk walk = triangleWalk(corners.a, corners.b, corners.c, RESOLUTION);
    // Tiles of the group's size over the box, dealt out to the slices in turn.
    ivec2 tiles = (walk.last.xy - walk.first.xy) / 8 + 1;
    for (int tile = int(gl_WorkGroupID.x); tile < tiles.x * tiles.y; tile += int(largeSlices)) {
        ITERATION;
        ivec2 at = walk.first.xy + 8 * ivec2(tile % tiles.x, tile / tiles.x) + ivec2(gl_LocalInvocationID.xy);
        if (at.x <= walk.last.x && at.y <= walk.last.y) markColumn(triangle, corners, walk, at.x, at.y);
    }
    ITERATIONS_END;
}

#else

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint triangle = group * 64u + gl_LocalInvocationIndex;
    if (triangle >= uint(triangleCount)) return;
    Corners corners = cornersOf(triangle);
    TriangleWalk walk = triangleWalk(corners.a, corners.b, corners.c, RESOLUTION);
    ivec2 size = max(walk.last.xy - walk.first.xy + 1, ivec2(0));
    int columns = size.x * size.y;
    if (columns > smallColumns) {
        uint place = atomicAdd(large.count, 1u);
        large.triangles[place] = triangle;
        atomicMax(large.groupsX, largeSlices);
        atomicMax(large.groupsY, min(place + 1u, maxGroups));
        atomicMax(large.groupsZ, place / maxGroups + 1u);
        columns = 0;
    }
    for (int i = 0; i < columns; ++i) {
        ITERATION;
        markColumn(triangle, corners, walk, walk.first.x + i % size.x, walk.first.y + i / size.x);
    }
    ITERATIONS_END;
}

#endif
