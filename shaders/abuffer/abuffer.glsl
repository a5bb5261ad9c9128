// The module `tracer` through an A-buffer: a ray goes from pixel to pixel of a view (2D DDA) and meets the fragments whose depth
// lies in the interval of depths that it has in the pixel, then goes on in the next view (Vardis, Vasilakis, Papaioannou 2016,
// section 3.4). What differs from the paper, and why:
//
//   - A ray passes from pixel to pixel at the times at which it meets the planes through the eye and the pixels' borders, each
//     worked out by itself and never summed up: nothing drifts, and tMin and tMax are times too.
//   - The interval is half open, and widened on both sides by half of THICKNESS pixel footprints: a surface is kept at the
//     depth of its pixel's centre, and a ray that crosses it elsewhere in the pixel would pass before it in one pixel and
//     behind it in the next. Skipping tests the widened interval, so that it changes no hit.
//   - Views are left by edge connectivity in one form for all borders, the near plane too: the axis of the face that is left
//     counts no more, and the largest of the other components of the place says which face comes next.
//
// A ray that has passed STEPS pixels is exhausted: it ends there as if it had hit something, and is counted with COUNT_EXHAUSTED.
#include "lib/tracer.glsl"
#include "lib/scene.glsl"
#include "lib/iterations.glsl"
#include "shared/ray.h"
#include "shared/view.h"
#include "abuffer/lists.glsl"

#ifdef COUNT_EXHAUSTED
layout(std430) buffer M(Exhausted) { uint M(exhausted)[]; };
#endif

void M(aim)(inout Ray ray) {}

#ifdef EMPTY
bool M(anyHit)(Ray ray) { return false; }
#if defined(REQUESTS_CLOSEST) || defined(REQUESTS_SURFACE)
bool M(closestHit)(Ray ray, out Hit hit) {
    hit = noHit;
    return false;
}
#endif
#ifdef REQUESTS_SURFACE
Surface M(surface)(Ray ray, Hit hit) { return facingSurface(ray, hit); }
#endif
#else

layout(r32ui) uniform readonly uimageBuffer M(pixels);
layout(r32ui) uniform readonly uimageBuffer M(nodes);
#if defined(REQUESTS_SURFACE) && defined(DECOUPLED)
layout(r32ui) uniform readonly uimageBuffer M(data);
#endif
layout(std140) uniform M(PixelsView) { ViewData M(view); };

float M(depthOf)(uint node) { return uintBitsToFloat(imageLoad(M(nodes), NODE_AT(node, 0)).r); }
uint M(nextOf)(uint node) { return imageLoad(M(nodes), NODE_AT(node, 1)).r; }
#ifdef TWO_WAYS
uint M(previousOf)(uint node) { return imageLoad(M(nodes), NODE_AT(node, 2)).r; }
#endif

// The fragment of a list of linked nodes that a ray meets first, whose depths in the pixel are [low, high): 0 if there is none.
uint M(inList)(uint head, uint tail, float low, float high, bool away) {
    uint found = 0u;
#ifdef TWO_WAYS
    if (!away) {
        for (uint node = tail; node != 0u; node = M(previousOf)(node)) {
            ITERATION;
            float z = M(depthOf)(node);
            if (z < low) break;
            if (z < high) {
                found = node;
                break;
            }
        }
        return found;
    }
#endif
    for (uint node = head; node != 0u; node = M(nextOf)(node)) {
        ITERATION;
        float z = M(depthOf)(node);
        if (z >= high) break;
        if (z >= low) {
            found = node;
            if (away) break; // coming nearer, the last one is met first
        }
    }
    return found;
}

// The same of a pixel.
uint M(inPixel)(int pixel, float low, float high, bool away) {
    int words = pixel * PIXEL_WORDS;
#if defined(SB)
    uint first = imageLoad(M(pixels), words).r;
    int count = int(imageLoad(M(pixels), words + 1).r);
#ifdef SKIPPING
    if (count == 0 || M(depthOf)(first) >= high || M(depthOf)(first + uint(count - 1)) < low) return 0u;
#endif
    // The first of them that is at least `low`, or coming nearer the last that is below `high`.
    int begin = 0;
    if (count > 16) {
        float wanted = away ? low : high;
        int end = count;
        while (begin < end) {
            ITERATION;
            int middle = (begin + end) / 2;
            if (M(depthOf)(first + uint(middle)) < wanted) {
                begin = middle + 1;
            } else {
                end = middle;
            }
        }
    } else {
        for (; begin < count; ++begin) {
            ITERATION;
            if (M(depthOf)(first + uint(begin)) >= (away ? low : high)) break;
        }
    }
    if (!away) --begin;
    if (begin < 0 || begin >= count) return 0u;
    float z = M(depthOf)(first + uint(begin));
    return z >= low && z < high ? first + uint(begin) : 0u;
#elif defined(BUCKETED)
    float zMin = uintBitsToFloat(imageLoad(M(pixels), words).r);
    float zMax = uintBitsToFloat(imageLoad(M(pixels), words + 1).r);
#ifdef SKIPPING
    if (zMax < low || zMin >= high) return 0u;
    int from = int(abufferBucket(low, zMin, zMax, uint(BUCKETS)));
    int to = int(abufferBucket(high, zMin, zMax, uint(BUCKETS)));
#else
    int from = 0;
    int to = BUCKETS - 1;
#endif
    uint found = 0u;
    int buckets = to - from + 1;
    for (int i = 0; i < buckets && found == 0u; ++i) {
        ITERATION;
        int bucket = away ? from + i : to - i;
        uint head = imageLoad(M(pixels), words + HEAD_WORD(bucket)).r;
#ifdef TWO_WAYS
        uint tail = imageLoad(M(pixels), words + TAIL_WORD(bucket)).r;
#else
        uint tail = 0u;
#endif
        found = M(inList)(head, tail, low, high, away);
    }
    return found;
#else
    uint head = imageLoad(M(pixels), words).r;
#ifdef TWO_WAYS
    uint tail = imageLoad(M(pixels), words + TAIL_WORD(0)).r;
#ifdef SKIPPING
    if (head == 0u || M(depthOf)(head) >= high || M(depthOf)(tail) < low) return 0u;
#endif
#else
    uint tail = 0u;
#endif
    return M(inList)(head, tail, low, high, away);
#endif
}

// ---- views

// A ray in a view: x, y, w of clip space and the depth along the view's axis, each at time 0 and what a unit of time adds.
struct M(ViewRay) {
    vec4 at;
    vec4 add;
};

M(ViewRay) M(inView)(uint view, vec3 origin, vec3 direction) {
    if (view == 0u) {
        vec4 at = M(view).viewProjection * vec4(origin, 1.0);
        vec4 add = M(view).viewProjection * vec4(direction, 0.0);
        return M(ViewRay)(vec4(at.xyw, -(M(view).view * vec4(origin, 1.0)).z),
                          vec4(add.xyw, -(M(view).view * vec4(direction, 0.0)).z));
    }
    vec3 at = abufferFaceAxes(view - 1u, origin - M(view).position.xyz);
    vec3 add = abufferFaceAxes(view - 1u, direction);
    at.z += NEAR_PLANE;
    return M(ViewRay)(at.xyzz, add.xyzz);
}

// Pixels of a view, and the size of a pixel at depth 1 or, of an orthographic frame, at any depth.
ivec2 M(sizeOf)(uint view) { return view == 0u ? ivec2(M(view).size) : ivec2(SIDE); }
float M(footprint)(uint view, float depth) {
    if (view == 0u) {
        float size = max(length(M(view).rightward.xyz), length(M(view).upward.xyz));
        return M(view).position.w != 0.0 ? size : size * depth;
    }
    return 2.0 / float(max(SIDE, 1)) * depth;
}

float M(nearOf)(uint view) { return view == 0u ? M(view).nearPlane : NEAR_PLANE; }

bool M(contains)(M(ViewRay) ray, float t, float nearPlane) {
    vec4 p = ray.at + t * ray.add;
    return abs(p.x) <= p.z && abs(p.y) <= p.z && p.w >= nearPlane;
}

// The time at which the ray leaves the view, after which it is on the wrong side of one of its planes.
float M(leaves)(M(ViewRay) ray, float nearPlane) {
    // Each is at least 0 within.
    vec4 sides = vec4(ray.at.z - ray.at.x, ray.at.z + ray.at.x, ray.at.z - ray.at.y, ray.at.z + ray.at.y);
    vec4 grow = vec4(ray.add.z - ray.add.x, ray.add.z + ray.add.x, ray.add.z - ray.add.y, ray.add.z + ray.add.y);
    vec4 times = mix(vec4(rayInfinity), -sides / grow, lessThan(grow, vec4(0.0)));
    float byNear = ray.add.w < 0.0 ? (nearPlane - ray.at.w) / ray.add.w : rayInfinity;
    return min(min(min(times.x, times.y), min(times.z, times.w)), byNear);
}

// Where a ray goes decides between faces, close to the eye: by less than what their frusta overlap there.
float M(onward)() { return 0.5 * NEAR_PLANE; }

struct M(March) {
    vec3 origin;
    vec3 direction;
    float tMax;
    float t;
    uint view; // where it is
    int views; // that it may still enter
    bool exhausted;
    // What was hit; node 0: nothing.
    uint node;
    float hitTime;
    float error;
};

// Goes on until something is hit, the ray ends or is exhausted.
void M(marchOn)(inout M(March) march) {
    march.exhausted = false;
    int steps = 0;
    while (march.views > 0) {
        ITERATION;
        M(ViewRay) ray = M(inView)(march.view, march.origin, march.direction);
        ivec2 size = M(sizeOf)(march.view);
        float end = min(march.tMax, M(leaves)(ray, M(nearOf)(march.view)));
        vec4 start = ray.at + march.t * ray.add;
        ivec2 pixel = clamp(ivec2(floor((start.xy / start.z * 0.5 + 0.5) * vec2(size))), ivec2(0), size - 1);
        // Which way the ray goes on the view's plane: the sign holds for all of it.
        ivec2 way = ivec2(sign(ray.add.xy * ray.at.z - ray.at.xy * ray.add.z));
        bool away = ray.add.w > 0.0;
        bool left = march.t >= end;
        while (!left) {
            ITERATION;
            if (steps >= STEPS) {
                march.exhausted = true;
                return;
            }
            ++steps;
            vec2 border = 2.0 * vec2(pixel + max(way, ivec2(0))) / vec2(size) - 1.0;
            // A ray that comes to an end at its vanishing point before the border never meets it.
            vec2 towards = ray.add.xy - border * ray.add.z;
            vec2 times = mix(vec2(rayInfinity), (border * ray.at.z - ray.at.xy) / towards, greaterThan(towards * vec2(way), vec2(0.0)));
            float next = max(march.t, min(min(times.x, times.y), end));
            float from = ray.at.w + march.t * ray.add.w;
            // A ray without end goes out of every interval of depths.
            float to = next < rayInfinity ? ray.at.w + next * ray.add.w : (ray.add.w == 0.0 ? from : (away ? 3.0e38 : -3.0e38));
            float low = min(from, to);
            float high = max(from, to);
            float pad = 0.5 * THICKNESS * M(footprint)(march.view, low);
            uint node = M(inPixel)(ABUFFER_PIXEL(march.view, pixel), low - pad, high + pad, away);
            if (node != 0u) {
                float z = M(depthOf)(node);
                float part = to != from ? clamp((z - from) / (to - from), 0.0, 1.0) : 0.5;
                march.node = node;
                march.hitTime = next < rayInfinity ? mix(march.t, next, part) : march.t + max(z - from, 0.0) / abs(ray.add.w);
                march.error = 0.5 * M(footprint)(march.view, z) + pad;
                return;
            }
            march.t = next;
            if (next >= end) {
                left = true;
            } else if (times.x <= times.y) {
                pixel.x += way.x;
                left = pixel.x < 0 || pixel.x >= size.x;
            } else {
                pixel.y += way.y;
                left = pixel.y < 0 || pixel.y >= size.y;
            }
        }
        if (march.t >= march.tMax || march.t == rayInfinity) return;
#if SIDE > 0
        vec3 place = march.origin + march.t * march.direction - M(view).position.xyz + M(onward)() * march.direction;
        if (march.view > 0u) {
            uint axis = (march.view - 1u) / 2u;
            if (axis == 0u) place.x = 0.0;
            if (axis == 1u) place.y = 0.0;
            if (axis == 2u) place.z = 0.0;
        }
        march.view = 1u + abufferFaceOf(place);
        --march.views;
#else
        return;
#endif
    }
}

bool M(traverse)(Ray ray, out M(March) march) {
    vec3 seen = ray.origin + (ray.tMin + M(onward)()) * ray.direction - M(view).position.xyz;
    march.view = 1u + abufferFaceOf(seen);
#if MAIN_PIXELS > 0
#if SIDE > 0
    if (M(contains)(M(inView)(0u, ray.origin + ray.tMin * ray.direction, ray.direction), 0.0, M(view).nearPlane)) march.view = 0u;
#else
    march.view = 0u;
#endif
#endif
    // Off the surface by what its fragments may be off their places.
    float depth = M(inView)(march.view, ray.origin, ray.direction).at.w;
    march.origin = ray.origin + ray.normal * (OFFSET * M(footprint)(march.view, max(depth, 0.0)));
    march.direction = ray.direction;
    march.tMax = ray.tMax;
    march.t = ray.tMin;
    march.views = 8;
    march.node = 0u;
    march.hitTime = ray.tMax;
    march.error = 0.0;
#if SIDE == 0
    // Outside the only view there is nothing to be hit.
    M(ViewRay) inMain = M(inView)(0u, march.origin, march.direction);
    if (!M(contains)(inMain, march.t, M(view).nearPlane)) march.views = 0;
#endif
    M(marchOn)(march);
#ifdef COUNT_EXHAUSTED
    atomicAdd(M(exhausted)[0], 1u);
    if (march.exhausted) atomicAdd(M(exhausted)[1], 1u);
#endif
    if (march.exhausted) march.hitTime = march.t;
    return march.node != 0u || march.exhausted;
}

bool M(anyHit)(Ray ray) {
    M(March) march;
    return M(traverse)(ray, march);
}

#if defined(REQUESTS_CLOSEST) || defined(REQUESTS_SURFACE)
bool M(closestHit)(Ray ray, out Hit hit) {
    M(March) march;
    bool found = M(traverse)(ray, march);
    hit = found ? Hit(march.hitTime, march.error, march.view, uvec2(march.node, 0u)) : noHit;
    return found;
}
#endif

#ifdef REQUESTS_SURFACE
// The triangle's surface where it is nearest to the hit; of an exhausted ray one that faces it.
Surface M(surface)(Ray ray, Hit hit) {
    if (hit.id.x == 0u) return facingSurface(ray, hit);
#if defined(DECOUPLED) && defined(SB)
    uint triangle = imageLoad(M(data), int(imageLoad(M(nodes), NODE_AT(hit.id.x, 1)).r) - 1).r;
#elif defined(DECOUPLED)
    uint triangle = imageLoad(M(data), int(hit.id.x) - 1).r;
#else
    uint triangle = imageLoad(M(nodes), NODE_AT(hit.id.x, NODE_WORDS - 1)).r;
#endif
    uvec4 corners = sceneTriangle(triangle);
    vec3 p0 = scenePosition(corners.x);
    vec3 a = scenePosition(corners.y) - p0;
    vec3 b = scenePosition(corners.z) - p0;
    vec3 p = ray.origin + hit.t * ray.direction - p0;
    float aa = dot(a, a);
    float ab = dot(a, b);
    float bb = dot(b, b);
    float area = aa * bb - ab * ab;
    vec2 barycentrics = area > 0.0 ? vec2(bb * dot(p, a) - ab * dot(p, b), aa * dot(p, b) - ab * dot(p, a)) / area : vec2(0.0);
    barycentrics = max(barycentrics, vec2(0.0));
    barycentrics /= max(barycentrics.x + barycentrics.y, 1.0);
    return sceneSurface(triangle, barycentrics, ray.direction);
}
#endif

#endif // EMPTY
