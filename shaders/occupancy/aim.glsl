// Part of the modules that trace through ray-aligned occupancy maps (occupancy/roma.glsl says how): settings, candidate
// directions, and how a ray gets its map.

layout(rgba32f) readonly uniform imageBuffer M(directions);
OccupancySettings M(settings)() { return alignedSettings(imageLoad(M(directions), 0)); }
RomaDirection M(candidate)(int map) {
    int at = 1 + 3 * map;
    return alignedCandidate(imageLoad(M(directions), at), imageLoad(M(directions), at + 1), imageLoad(M(directions), at + 2));
}

#ifdef COUNT_EXHAUSTED
layout(std430) buffer M(Exhausted) { uint M(exhausted)[]; };
#endif

void M(aim)(inout Ray ray) {
    aimAligned(ray, ANGULAR);
#ifdef REQUESTS_SNAP
    snapAligned(ray, M(candidate)(alignedMap(ray)));
#endif
}
