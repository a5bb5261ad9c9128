// One round of 3D jump flooding (Rong and Tan, "Jump Flooding in GPU with Applications to Voronoi Diagram and Distance
// Transform", 2006): each cell takes the nearest of the seeds that the 27 cells STRIDE apart know. FIRST reads the seeds
// from the map, LAST writes distances.
#include "distance_field/half.glsl"
#include "shared/occupancy.h"

layout(local_size_x = 32, local_size_y = 8) in;

#ifdef FIRST
#ifdef BASE_STORAGE
layout(std430) readonly buffer Occupancy { uint words[]; };
#define WORD(index) words[index]
#else
layout(r32ui) readonly uniform uimageBuffer occupancy;
#define WORD(index) imageLoad(occupancy, index).x
#endif
#else
layout(r32ui) readonly uniform uimage3D FROM;
#endif
#ifdef LAST
layout(r16f) writeonly uniform image3D field;
#else
layout(r32ui) writeonly uniform uimage3D TO;
#endif

// A seed is its cell in 8 bits an axis, and a bit that tells it from none.
const uint isSeed = 0x1000000u;

uint seedOf(ivec3 cell) {
#ifdef FIRST
    bool inside = (cell.x | cell.y | cell.z) >= 0 && max(max(cell.x, cell.y), cell.z) < RESOLUTION;
    ivec3 at = inside ? cell : ivec3(0);
    uint word = WORD(occupancyWord(at.x, at.y, at.z, RESOLUTION));
    bool occupied = inside && (word >> uint(at.z & 31) & 1u) != 0u;
    return occupied ? isSeed | uint(at.z << 16 | at.y << 8 | at.x) : 0u;
#else
    return imageLoad(FROM, cell).x; // outside of the image 0
#endif
}

void main() {
    ivec3 cell = ivec3(gl_GlobalInvocationID);
    vec3 centre = vec3(cell);
    uint nearest = 0u;
    float least = float(4 * RESOLUTION * RESOLUTION); // above any: what a map without cells keeps
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) {
                uint seed = seedOf(cell + STRIDE * ivec3(x, y, z));
                vec3 apart = vec3(ivec3(uvec3(seed, seed >> 8u, seed >> 16u) & 255u)) - centre; // signed converts faster
                float squared = dot(apart, apart);
                if (seed != 0u && squared < least) {
                    least = squared;
                    nearest = seed;
                }
            }
#ifdef LAST
    imageStore(field, cell, vec4(nearestHalf(sqrt(least))));
#else
    imageStore(TO, cell, uvec4(nearest));
#endif
}
