// What the tracers through ray-aligned occupancy maps share: directions, and walking from column to column.
#include "lib/occupancy.glsl"
#include "shared/roma.h"

// In a ray's token beside its map: it goes against the map's z axis.
const uint alignedFlipped = 0x80000000u;

// The buffer `directions` by texels: settings, then three texels a candidate. Each ray chooses an element
// for itself, which a CPU driver fetches number by number from a uniform block: by texels a snapped query takes a tenth less.
OccupancySettings alignedSettings(vec4 texel) { return OccupancySettings(texel.x, texel.y, texel.z, texel.w); }
RomaDirection alignedCandidate(vec4 a, vec4 b, vec4 c) {
    return RomaDirection(a.xyz, a.w, b.xyz, b.w, c.x, c.y, c.z, c.w);
}

int alignedMap(Ray ray) { return int(ray.token & 0xffffu); }
bool alignedUp(Ray ray) { return (ray.token & alignedFlipped) == 0u; }

// Chooses the map of the ray's stratum.
void aimAligned(inout Ray ray, int angular) {
    float flip = ray.direction.z < 0.0 ? -1.0 : 1.0;
    ray.token = uint(stratumOf(flip * ray.direction, angular)) | (flip < 0.0 ? alignedFlipped : 0u);
}

// Snaps the ray, aimed before, to the candidate of its map.
void snapAligned(inout Ray ray, RomaDirection own) {
    float flip = alignedUp(ray) ? 1.0 : -1.0;
    ray.direction = flip * own.direction;
    if (ray.normal != vec3(0.0)) ray.weight *= romaWeight(own, flip, ray.direction, ray.normal);
}

// A vector in the axes of the map along `axis`.
vec3 align(vec3 v, vec3 axis) { return vec3(dot(v, romaAxisX(axis)), dot(v, romaAxisY(axis)), dot(v, axis)); }

// A ray that is not snapped on its way from column to column, in cells of its map.
struct ColumnWalk {
    vec3 origin;
    vec3 direction;
    vec3 inverse;
    ivec2 at;     // the column
    ivec2 onward; // 1 or -1: which way along x and y
    vec2 leave;   // where the column ends, along x and y
    vec2 across;  // from column to column
    float from;   // the ray's way within the column
    float end;
    float to;     // where the ray ends
    bool intersects;    // it meets the map
};

ColumnWalk beginWalk(vec3 origin, vec3 direction, float from, float to, int resolution) {
    ColumnWalk walk;
    walk.origin = origin;
    walk.direction = direction;
    walk.inverse = finiteInverse(direction);
    // The part of the ray inside the map.
    vec3 low = -origin * walk.inverse;
    vec3 high = (vec3(resolution) - origin) * walk.inverse;
    vec3 nearer = min(low, high);
    vec3 farther = max(low, high);
    walk.from = max(from, max(nearer.x, max(nearer.y, nearer.z)));
    walk.to = min(to, min(farther.x, min(farther.y, farther.z)));
    walk.intersects = walk.from <= walk.to;
    walk.at = clamp(ivec2(floor(origin.xy + walk.from * direction.xy)), ivec2(0), ivec2(resolution - 1));
    walk.onward = ivec2(direction.x < 0.0 ? -1 : 1, direction.y < 0.0 ? -1 : 1);
    walk.leave = (vec2(walk.at + max(walk.onward, ivec2(0))) - origin.xy) * walk.inverse.xy;
    walk.across = abs(walk.inverse.xy);
    walk.end = min(walk.to, min(walk.leave.x, walk.leave.y));
    return walk;
}

// The first occupied cell of the ray's way within its column; -1 if there is none.
int walkCell(ColumnWalk walk, OccupancyColumn column, int resolution) {
    float z0 = walk.origin.z + walk.from * walk.direction.z;
    float z1 = walk.origin.z + walk.end * walk.direction.z;
    int first = cellAt(min(z0, z1), resolution);
    int last = cellAt(max(z0, z1), resolution);
    return columnFirst(columnPart(column, first, last), walk.direction.z >= 0.0);
}

// The middle of the ray's way through that cell.
float walkMiddle(ColumnWalk walk, int cell) {
    float a = (float(cell) - walk.origin.z) * walk.inverse.z;
    float b = (float(cell + 1) - walk.origin.z) * walk.inverse.z;
    return 0.5 * (clamp(min(a, b), walk.from, walk.end) + clamp(max(a, b), walk.from, walk.end));
}

// On to the next column; false where the ray ends.
bool walkOn(inout ColumnWalk walk, int resolution) {
    bool more = walk.end < walk.to;
    bvec2 next = bvec2(walk.leave.x <= walk.leave.y, walk.leave.x > walk.leave.y);
    walk.at += walk.onward * ivec2(next);
    walk.leave += walk.across * vec2(next);
    walk.from = walk.end;
    walk.end = min(walk.to, min(walk.leave.x, walk.leave.y));
    return more && hasColumn(walk.at, resolution);
}
