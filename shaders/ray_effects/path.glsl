// What the programs of PathTrace share: paths as records in a buffer, and what a path does at a surface. The program
// includes the module `radiance` before this file. Defines: SAMPLES (paths a pixel and frame), REQUIRES_SURFACE (the module asks for
// normals and materials), LAST (no path goes on), TRACES (paths are read).
#include "lib/frame.glsl"
#include "lib/sampling.glsl"
#include "shared/bsdf.h"
#include "shared/random.h"
#include "shared/ray.h"
#include "shared/work_list.h"

// A record: origin, off the face, and the lobe that drew the ray; direction; throughput and pixel (packPixel()); normal of the
// face on the side that the ray leaves to. And the light that it has brought: at the first surface, and by its rays.
const uint pathRecordTexels = 4u;
#if !defined(LAST) || defined(TRACES)
layout(std430) buffer Paths { vec4 paths[]; };
// The slots whose paths go on after each bounce, one list (shared/work_list.h) behind another, ALIVE_WORDS apart. Dead paths that
// keep their places are paid for on a driver that jumps over no branch: through a BVH four bounces on `blob` under no sky took
// 2.1 times as long without the lists, in the closed `pool` as long.
layout(std430) buffer Alive { uint alive[]; };
const uint aliveHeader = 8u; // words
shared uint aliveCount;
shared uint aliveFirst;

// To be called by every invocation of the group: one atomic a group, since those of all groups meet.
void goOn(uint slot, bool goes, uint list) {
    if (gl_LocalInvocationIndex == 0u) aliveCount = 0u;
    barrier();
    uint place = goes ? atomicAdd(aliveCount, 1u) : 0u;
    barrier();
    uint at = list * uint(ALIVE_WORDS);
    if (gl_LocalInvocationIndex == 0u && aliveCount > 0u) {
        aliveFirst = atomicAdd(alive[at], aliveCount);
        atomicMax(alive[at + 4u], (aliveFirst + aliveCount + workListGroup - 1u) / workListGroup);
    }
    barrier();
    if (goes) alive[at + aliveHeader + aliveFirst + place] = slot;
}
#endif
layout(std430) buffer Light { vec4 light[]; };

uniform uint path; // which of the frame's paths of a pixel this is

// A pair of numbers of the pixel's path, for one of four uses at a bounce.
vec2 pathNumbers(ivec2 pixel, uint bounce, uint use) {
    uint seed = pixelSeed(uvec2(pixel), randomPath + 4u * bounce + use, frame.seed);
    return scrambledSobol(frame.index * uint(SAMPLES) + path, seed);
}

// Light that leaves `at` towards where the path came from because of the lights. The ray that the path goes on along is
// stored in the slot's record, unless this is the last bounce; `exists` becomes false where there is none. `start`: how far
// off the face rays begin.
vec3 scatter(Surface at, BsdfSurface bsdf, vec3 toward, float start, vec3 throughput, uint slot, ivec2 pixel, uint bounce,
             inout bool exists) {
    // A smooth normal can look away from where the path comes from; the face never does.
    vec3 normal = dot(at.shadingNormal, toward) > 0.0 ? at.shadingNormal : at.normal;
    mat3 basis = basisAround(normal);
    vec3 cosineWeighted = cosineHemisphere(pathNumbers(pixel, bounce, 2u), vec3(0.0, 0.0, 1.0));
    BsdfSample drawn = sampleBsdf(bsdf, toward * basis, pathNumbers(pixel, bounce, 0u).x, pathNumbers(pixel, bounce, 1u),
                                  cosineWeighted);

    // The path counts emission itself, and tells the module which part of the surface the lights are asked for.
    at.emission = vec3(0.0);
    at.shadingNormal = normal;
#ifdef REQUIRES_SURFACE
    at.albedo = drawn.diffuse;
    at.metallic = 0.0;
    vec3 lit = radiance_surface(at, toward);
#else
    // What the module tells has the surface's colour, and what of it is no metal, in it already.
    float colour = max(bsdf.colour.r, max(bsdf.colour.g, bsdf.colour.b));
    float share = max(drawn.diffuse.r, max(drawn.diffuse.g, drawn.diffuse.b)) / max(colour * (1.0 - bsdf.metallic), 1e-6);
    vec3 lit = share * radiance_surface(at, toward);
#endif

#ifndef LAST
    vec3 direction = normalize(basis * drawn.direction);
    vec3 side = drawn.lobe == bsdfTransmission ? -at.normal : at.normal;
    exists = exists && drawn.lobe != bsdfNone && leavesFace(direction, side);
    if (exists) {
        uint record = slot * pathRecordTexels;
        paths[record] = vec4(at.position + start * side, uintBitsToFloat(drawn.lobe));
        paths[record + 1u] = vec4(direction, 0.0);
        paths[record + 2u] = vec4(throughput * drawn.weight, uintBitsToFloat(packPixel(uint(pixel.x), uint(pixel.y))));
        paths[record + 3u] = vec4(side, 0.0);
    }
#endif
    return throughput * lit;
}
