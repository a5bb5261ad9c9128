// Module: `tracer` (PROVIDES_TRACER) or `hits` (PROVIDES_HITS) through a hierarchy of four children a node. Layout:
// shared/wide_bvh.h; the CPU mirror is framework/scene/bvh_trace.cpp.
#include "lib/tracer.glsl"
#include "lib/scene.glsl"
#include "lib/iterations.glsl"
#include "shared/ray.h"
#include "shared/triangle.h"
#include "shared/wide_bvh.h"

layout(rgba32ui) uniform readonly uimageBuffer M(items);

void M(aim)(inout Ray ray) {}

// A walk: the item to look at next, children that wait (wideChildren()), and how many more words of them.
struct M(Walk) {
    WideRay boxes;
    TriangleRay sheared;
    uint at; // its first texel
    uint waiting;
    int size; // below 0: done
};
uint M(stack)[wideStackSize];

M(Walk) M(start)(Ray ray) {
    vec3 origin = offFace(ray.origin, ray.normal);
    return M(Walk)(wideRay(inverseDirection(ray.direction)), triangleRay(origin, ray.direction), 0u, 0u, 0);
}

// Looks at one item, a node or a triangle, and goes on to the next. On a driver that runs both sides of every branch for
// all lanes, the test of a triangle beside the test of four boxes costs less than a loop for each, in which lanes wait
// for each other. What leads to the next item stands first and the triangle, which the next item does not wait for, last:
// a processor tests it while the next item is on its way from memory. Whether it is a triangle that the ray meets.
bool M(step)(inout M(Walk) walk, float tMin, float tMax, bool nearestFirst, out TriangleHit hit, out uvec3 ids) {
    int texel = int(walk.at);
    uint above = M(stack)[max(walk.size - 1, 0)]; // to have it once it is known whether it is asked for
    uvec4 a = imageLoad(M(items), texel);
    uvec4 b = imageLoad(M(items), texel + 1);
    uvec4 c = imageLoad(M(items), texel + 2);
    ids = uvec3(a.w, b.w, c.w);
    bool node = (a.w & wideNode) != 0u;
    ivec4 entries;
    uint children = node ? wideMet(walk.boxes, walk.sheared.origin, tMin, tMax, a, b, c, entries) : 0u;

    // Down, sideways or up: what waits is kept always, and counted where something lies below and beside.
    bool down = children != 0u;
    bool beside = (walk.waiting & 15u) != 0u;
    M(stack)[walk.size] = walk.waiting;
    walk.size += down ? (beside ? 1 : 0) : (beside ? 0 : -1);
    uint waiting = down ? wideChildren(b.w, children) : (beside ? walk.waiting : above);
    uint bit = waiting & (~waiting + 1u);
    if (nearestFirst) {
        // By bits, the lowest two of which give way to the child's number.
        ivec4 keys = mix(ivec4(0x7fffffff), (entries & ~3) | ivec4(0, 1, 2, 3),
                         notEqual(uvec4(children) & uvec4(1u, 2u, 4u, 8u), uvec4(0u)));
        int nearest = min(min(keys.x, keys.y), min(keys.z, keys.w)) & 3;
        if (down) bit = 1u << uint(nearest);
    }
    bit &= 15u;
    walk.at = (waiting >> 4u) + wideTexelOf(bit);
    walk.waiting = waiting & ~bit;
    return !node && intersectTriangle(walk.sheared, tMin, tMax, uintBitsToFloat(a.xyz), uintBitsToFloat(b.xyz),
                                      uintBitsToFloat(c.xyz), hit);
}

#ifdef PROVIDES_TRACER

// Conditions stand at the ends of loops: at the beginning they cost a pass through the body for nothing, since a driver that
// masks lanes leaves a loop at its end alone. What a loop finds is assigned beside its `break`: llvmpipe (Mesa 22.3.6) goes on
// computing what a lane that has left would have assigned, and after nested loops gives that; also where one `break` stands for
// both ends, as in `if (met || walk.size < 0)` (closest hits through masks are wrong then).

#ifdef MATERIAL_MASKED
// Walks to the next triangle that the ray meets. The alpha test stands outside of this loop: in it, all lanes would pay for
// it at every item.
bool M(next)(inout M(Walk) walk, float tMin, float tMax, bool nearestFirst, out TriangleHit hit, out uint triangle,
             out bool tested) {
    bool found = false;
    hit = TriangleHit(0.0, 0.0, 0.0);
    triangle = 0xffffffffu;
    tested = false;
    while (true) {
        ITERATION;
        TriangleHit candidate;
        uvec3 ids;
        if (M(step)(walk, tMin, tMax, nearestFirst, candidate, ids)) {
            hit = candidate;
            triangle = ids.x;
            tested = ids.z >= 2u;
            found = true;
            break;
        }
        if (walk.size < 0) break;
    }
    return found;
}
#endif

bool M(anyHit)(Ray ray) {
    M(Walk) walk = M(start)(ray);
    bool found = false;
    while (true) {
        ITERATION;
        TriangleHit hit;
#ifdef MATERIAL_MASKED
        uint triangle;
        bool tested;
        bool met = M(next)(walk, ray.tMin, ray.tMax, false, hit, triangle, tested);
        if (tested) met = sceneCovers(triangle, vec2(hit.u, hit.v));
#else
        uvec3 ids;
        bool met = M(step)(walk, ray.tMin, ray.tMax, false, hit, ids);
#endif
        if (met) {
            found = true;
            break;
        }
        if (walk.size < 0) break;
    }
    return found;
}

#ifdef REQUESTS_MANY
// Of rays that are had by number (up to 32, those of `wanted`), which meet something. A lane whose ray is decided takes its
// next one after every few items, so that lanes wait for each other a few items long, not as long as the longest of eight
// rays is; and the alpha test is done then, once for all.
uint M(anyHits)(uint wanted) {
#ifdef MATERIAL_MASKED
    const int stretch = 16; // items
#else
    const int stretch = 12;
#endif
    M(Walk) walk;
    walk.size = -1;
    Ray ray;
    uint current = 0u, hits = 0u;
    bool idle = true;
    while (wanted != 0u || !idle) {
        ITERATION;
        if (idle) {
            current = wanted & (~wanted + 1u);
            wanted ^= current;
            ray = M(ray)(uint(findLSB(current)));
            walk = M(start)(ray);
            idle = false;
        }
        bool met = false, tested = false;
        uint triangle = 0u;
        vec2 barycentrics = vec2(0.0);
        for (int i = 0; i < stretch; ++i) {
            ITERATION;
            TriangleHit hit;
            uvec3 ids;
            if (M(step)(walk, ray.tMin, ray.tMax, false, hit, ids)) {
                met = true;
                tested = ids.z >= 2u;
                triangle = ids.x;
                barycentrics = vec2(hit.u, hit.v);
                break;
            }
            if (walk.size < 0) break;
        }
#ifdef MATERIAL_MASKED
        if (tested) met = sceneCovers(triangle, barycentrics);
#endif
        if (met) hits |= current;
        idle = met || walk.size < 0;
    }
    return hits;
}
#endif

#ifdef REQUESTS_MANY_CLOSEST
// Likewise what each of them meets first.
void M(closestHits)(uint wanted) {
#ifdef MATERIAL_MASKED
    const int stretch = 12; // items
#else
    const int stretch = 24; // as good on scattered rays, better on those that stay together
#endif
    M(Walk) walk;
    walk.size = -1;
    Ray ray;
    uint current = 0u, nearest = 0xffffffffu;
    TriangleHit best;
    bool idle = true;
    while (wanted != 0u || !idle) {
        ITERATION;
        if (idle) {
            current = uint(findLSB(wanted));
            wanted &= wanted - 1u;
            ray = M(ray)(current);
            walk = M(start)(ray);
            best = TriangleHit(ray.tMax, 0.0, 0.0);
            nearest = 0xffffffffu;
        }
#ifdef MATERIAL_MASKED
        bool met = false, tested = false;
        uint triangle = 0u;
        TriangleHit candidate = best;
#endif
        for (int i = 0; i < stretch; ++i) {
            ITERATION;
            TriangleHit hit;
            uvec3 ids;
            bool meets = M(step)(walk, ray.tMin, best.t, true, hit, ids);
#ifdef MATERIAL_MASKED
            if (meets) {
                met = true;
                tested = ids.z >= 2u;
                triangle = ids.x;
                candidate = hit;
                break;
            }
#else
            // Among hits at one distance the lowest triangle counts.
            if (meets && (hit.t < best.t || ids.x < nearest)) {
                best = hit;
                nearest = ids.x;
            }
#endif
            if (walk.size < 0) break;
        }
#ifdef MATERIAL_MASKED
        if (tested) met = sceneCovers(triangle, vec2(candidate.u, candidate.v));
        if (met && (candidate.t < best.t || triangle < nearest)) {
            best = candidate;
            nearest = triangle;
        }
#endif
        idle = walk.size < 0;
        if (idle)
            M(give)(current, nearest != 0xffffffffu, Hit(best.t, 0.0, 0u, uvec2(nearest, packUnorm2x16(vec2(best.u, best.v)))));
    }
}
#endif

#if defined(REQUESTS_CLOSEST) || defined(REQUESTS_SURFACE)
bool M(closestHit)(Ray ray, out Hit hit) {
    M(Walk) walk = M(start)(ray);
    TriangleHit best = TriangleHit(ray.tMax, 0.0, 0.0);
    uint triangle = 0xffffffffu;
    bool found = false;
    do {
        ITERATION;
        TriangleHit candidate;
#ifdef MATERIAL_MASKED
        uint id;
        bool tested;
        bool met = M(next)(walk, ray.tMin, best.t, true, candidate, id, tested);
        if (tested) met = sceneCovers(id, vec2(candidate.u, candidate.v));
#else
        uvec3 ids;
        bool met = M(step)(walk, ray.tMin, best.t, true, candidate, ids);
        uint id = ids.x;
#endif
        // Among hits at one distance the lowest triangle counts, so that the order of the walk does not.
        if (met && (!found || candidate.t < best.t || id < triangle)) {
            best = candidate;
            triangle = id;
            found = true;
        }
    } while (walk.size >= 0);
    hit = Hit(best.t, 0.0, 0u, uvec2(triangle, packUnorm2x16(vec2(best.u, best.v))));
    return found;
}
#endif

#ifdef REQUESTS_SURFACE
Surface M(surface)(Ray ray, Hit hit) { return sceneSurface(hit.id.x, unpackUnorm2x16(hit.id.y), ray.direction); }
#endif

#endif // PROVIDES_TRACER

#ifdef PROVIDES_HITS

// About front to back: who keeps a few of the hits may end the ray once it has them (Listing 1 of the stochastic depth map's
// paper), and those are to be the near ones.
void M(all)(Ray ray) {
    M(Walk) walk = M(start)(ray);
    bool stopped = false;
    do {
        ITERATION;
        TriangleHit hit;
        uvec3 ids;
        bool met = M(step)(walk, ray.tMin, ray.tMax, true, hit, ids);
#ifdef MATERIAL_MASKED
        if (met && ids.z >= 2u) met = sceneCovers(ids.x, vec2(hit.u, hit.v));
#endif
        if (met) stopped = M(visit)(ray, Hit(hit.t, 0.0, 0u, uvec2(ids.x, packUnorm2x16(vec2(hit.u, hit.v)))));
    } while (!stopped && walk.size >= 0);
}

#endif // PROVIDES_HITS
