// Makes rotated maps from the occupied cells alone: each finds the cells of a map whose centres lie in it, one on average,
// and sets their bits in the map, which was cleared (BLANK does that). rotate.comp visits every cell of every map instead
// and asks the base map, with the same bits as the result; surfaces occupy one or two cells in a hundred.
//
// A turned cell's cube reaches at most half a diagonal, 0.87 cells, from its middle: along each axis of the map two centres
// at most are that near, eight candidates in all, which exact arithmetic decides about.
#include "occupancy/rotation.glsl"

layout(local_size_x = 64) in; // scatterGroup

#ifdef BLANK
layout(std430) writeonly buffer Maps { uvec4 maps[]; };

void main() {
    const int texels = RESOLUTION * RESOLUTION * WORDS / 4;
    maps[(FIRST_MAP + MAP(int(gl_GlobalInvocationID.y))) * texels + int(gl_GlobalInvocationID.x)] = uvec4(0u);
}
#else
layout(std140) uniform Rotations { RomaRotation rotations[DIRECTIONS]; };
layout(std430) buffer Maps { uint maps[]; };
#include "occupancy/cell_lists.glsl"

void main() {
    int map = MAP(int(gl_GlobalInvocationID.y));
    ivec3 halfX = rotations[map].halfX.xyz;
    ivec3 halfY = rotations[map].halfY.xyz;
    ivec3 halfZ = rotations[map].halfZ.xyz;
    const float unit = 2.0 / float(1 << whole);
    vec3 axisX = vec3(halfX) * unit;
    vec3 axisY = vec3(halfY) * unit;
    vec3 axisZ = vec3(halfZ) * unit;
    // How far the turned cube reaches along each axis, and what rounding may add.
    vec3 reach = 0.5 * vec3(dot(abs(axisX), vec3(1.0)), dot(abs(axisY), vec3(1.0)), dot(abs(axisZ), vec3(1.0))) + 1e-3;
    ivec3 stepX = 2 * halfX;
    ivec3 stepY = 2 * halfY;
    ivec3 stepZ = 2 * halfZ;
    const int outside = ~((1 << whole) - 1);

    // What all of an invocation's cells hit is set in one loop: neighbours then make about as many iterations.
    uint hits = 0u; // bit 8 i + n: candidate n of cell i
    ivec3 first[scatterCells];
    uint at = gl_WorkGroupID.x * (scatterGroup * scatterCells) + gl_LocalInvocationID.x;
    for (uint i = 0u; i < scatterCells; ++i, at += scatterGroup) {
        bool exists = at < LIST.header.count;
        ivec3 cell = unpackCell(exists ? LIST.cells[at] : 0u);
        vec3 centred = vec3(cell) + (0.5 - float(RESOLUTION / 2));
        vec3 turned = vec3(dot(centred, axisX), dot(centred, axisY), dot(centred, axisZ)) + (float(RESOLUTION / 2) - 0.5);
        first[i] = ivec3(ceil(turned - reach));
        // From the base cell's corner, of the eight centres in turn.
        ivec3 from = centreOf(first[i], halfX, halfY, halfZ) - (cell << whole);
        uint found = 0u;
#define CANDIDATE(n, right, up, on)                                                                                          \
    {                                                                                                                        \
        ivec3 p = from + right * stepX + up * stepY + on * stepZ;                                                            \
        found |= ((p.x | p.y | p.z) & outside) == 0 ? n : 0u;                                                                 \
    }
        CANDIDATE(1u, 0, 0, 0)
        CANDIDATE(2u, 1, 0, 0)
        CANDIDATE(4u, 0, 1, 0)
        CANDIDATE(8u, 1, 1, 0)
        CANDIDATE(16u, 0, 0, 1)
        CANDIDATE(32u, 1, 0, 1)
        CANDIDATE(64u, 0, 1, 1)
        CANDIDATE(128u, 1, 1, 1)
        hits |= exists ? found << (8u * i) : 0u;
    }
    while (hits != 0u) {
        int n = findLSB(hits);
        hits &= hits - 1u;
        // Not first[n >> 3]: a register holds what is not indexed by a variable.
        ivec3 origin = n < 16 ? (n < 8 ? first[0] : first[1]) : (n < 24 ? first[2] : first[3]);
        ivec3 hit = origin + ivec3(n & 1, (n >> 1) & 1, (n >> 2) & 1);
        if (((hit.x | hit.y | hit.z) & ~(RESOLUTION - 1)) == 0) {
            int word = (((FIRST_MAP + map) * RESOLUTION + hit.y) * RESOLUTION + hit.x) * WORDS + (hit.z >> 5);
            atomicOr(maps[word], 1u << uint(hit.z & 31));
        }
    }
}
#endif
