// The module `tracer` by sphere tracing a distance field, accelerated by its coarser levels (Aaltonen, "GPU-based Clay
// Simulation and Ray-tracing Tech in Claybook", 2018), as the ROMA paper traces it (section 7).
//
// The field holds, in cells, the distance from a cell's centre to the centre of the nearest occupied cell. A ray hits
// where the interpolated distance falls below a threshold. Directions are not replaced.
//
// By step (the default), a level is sampled only where the last step was long in cells of that level; where it turns
// out to be close to something, the next finer level is asked before the ray goes on, and only the finest tells hits.
// BY_TRAVEL takes the level by how far the ray has come, as if it widened: hits far away are as coarse as their level.
//
// After ITERATIONS samples a ray counts as unoccluded. The reported t is where the threshold was met plus the distance
// that was left there, kept within [tMin, tMax].
#include "lib/tracer.glsl"
#include "lib/iterations.glsl"
#include "shared/occupancy.h"
#include "shared/distance_field.h"

void M(aim)(inout Ray ray) {}

#ifdef EMPTY
#include <part:lib/no_hits.glsl>
#else

layout(std140) uniform M(Grid) { OccupancyGrid M(grid); };
layout(std140) uniform M(Settings) { DistanceFieldSettings M(settings); };
uniform sampler3D M(field);

// 1 / x, huge in place of infinite: what it is multiplied with may be zero.
float M(inverse)(float x) { return abs(x) > 1e-12 ? 1.0 / x : (x < 0.0 ? -1e12 : 1e12); }

// How many of the lengths 2, 4, 8… `size` reaches: a level, below LEVELS.
float M(levelOf)(float size) {
    float level = 0.0;
    for (int i = 1; i < LEVELS; ++i) level += size >= float(1 << i) ? 1.0 : 0.0;
    return level;
}

// Whether something is met in [tMin, tMax]; t in cells, and how far it is from there.
bool M(march)(Ray ray, out float t, out float rest) {
    vec3 origin = cellsOf(M(grid), ray.origin) + M(settings).originOffset * ray.normal;
    vec3 inverse = vec3(M(inverse)(ray.direction.x), M(inverse)(ray.direction.y), M(inverse)(ray.direction.z));
    vec3 low = -origin * inverse;
    vec3 high = (vec3(RESOLUTION) - origin) * inverse;
    vec3 nearer = min(low, high);
    vec3 farther = max(low, high);
    float begin = max(ray.tMin * M(grid).inverseCellSize, ray.normal != vec3(0.0) ? M(settings).skip : 0.0);
    t = max(begin, max(nearer.x, max(nearer.y, nearer.z)));
    float end = min(ray.tMax * M(grid).inverseCellSize, min(farther.x, min(farther.y, farther.z)));
    rest = 0.0;
    bool found = false;
    if (!(t <= end)) return false;
    float level = 0.0;
    for (int i = 0; i < ITERATIONS; ++i) {
        ITERATION;
#ifdef BY_TRAVEL
        level = M(levelOf)(t * M(settings).widening);
#endif
        rest = textureLod(M(field), (origin + t * ray.direction) * (1.0 / float(RESOLUTION)), level).x;
        float size = exp2(level);
#ifdef BY_TRAVEL
        if (rest < M(settings).threshold * size) {
#else
        if (level == 0.0 && rest < M(settings).threshold) {
#endif
            found = true;
            break;
        }
#ifdef BY_TRAVEL
        t += max(rest * M(settings).scale, M(settings).leastStep);
#else
        bool close = level > 0.0 && rest < M(settings).margin * size;
        t += close ? 0.0 : max(rest * M(settings).scale, M(settings).leastStep);
        level = close ? level - 1.0 : M(levelOf)(rest / M(settings).margin);
#endif
        if (t > end) break;
    }
    return found;
}

bool M(anyHit)(Ray ray) {
    float t, rest;
    return M(march)(ray, t, rest);
}

bool M(closestHit)(Ray ray, out Hit hit) {
    hit = noHit;
    float t, rest;
    if (!M(march)(ray, t, rest)) return false;
    hit.t = clamp((t + rest) * M(grid).cellSize, ray.tMin, ray.tMax);
    // The cell's centre is within `rest` of t, its corners half a diagonal from there. What the ray met from where it was
    // moved to is reported on the ray that was asked for.
    float moved = ray.normal != vec3(0.0) ? M(settings).originOffset : 0.0;
    hit.error = (2.0 * rest + 0.8660254 + moved) * M(grid).cellSize;
    return true;
}

#endif // EMPTY
