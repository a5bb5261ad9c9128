// A ray's way through the pixels of an A-buffer's views (Vardis, Vasilakis, Papaioannou 2016, section 3.4): what the
// modules for fragments and for primitives share. What differs from the paper, and why:
//
//   - A ray passes from pixel to pixel at the times at which it meets the planes through the eye and the pixels'
//     borders, each worked out by itself and never summed up: nothing drifts, tMin and tMax are times too, and the
//     times that a ray spends in its pixels lie end to end, whatever the view.
//   - Views are left by edge connectivity in one form for all borders, the near plane too: the axis of the face that is
//     left counts no more, and the largest of the other components of the place says which face comes next.
//
// Positions count from the frame's eye, so that nothing is lost where the scene lies far from the origin.
#include "lib/tracer.glsl"
#include "lib/iterations.glsl"
#include "shared/abuffer.h"
#include "shared/random.h"
#include "shared/view.h"

// Which views there are: the frame's (0), and with a side the six faces of the cube (1 + face).
struct ABufferShape {
    bool mainView;
    int side;
    float nearPlane; // of the cube
};
// By a module's own defines.
#define ABUFFER_SHAPE ABufferShape(MAIN_PIXELS > 0, SIDE, NEAR_PLANE)

// A ray in a view: x, y, w of clip space and the depth along the view's axis, each at time 0 and what a unit of time
// adds.
struct ABufferRay {
    vec4 at;
    vec4 add;
};

struct ABufferMarch {
    vec3 origin; // from the frame's eye
    vec3 direction;
    float tMax;
    float t; // where it is
    uint view;
    int views; // that it may still enter
    // In the view.
    ABufferRay ray;
    ivec2 size;
    float end; // the time at which it leaves the view or ends
    ivec2 pixel;
    ivec2 way; // the signs that hold for all of it in the view
    bool inside;
    // In the pixel, or in a block of 4^level times 4^level pixels: the borders ahead and the times at which it meets
    // them, when it leaves, and its depths.
    int level;
    ivec2 border;
    vec2 times;
    float next;
    float from;
    float to;
    // With a fixed number of samples: its way over the view in equal parts, each looked at in one pixel.
    vec2 first;
    vec2 last;
    int parts;
    int part;
    float jitter; // where in each part, [0, 1)
};

// How a ray passes a view: pixel by pixel, by blocks of pixels where there are `levels` of them, or, with `samples`
// other than 0, looking at so many pixels at most. Constants, so that a program has only what it runs.
struct ABufferSteps {
    int levels;
    int samples;
};

// A place `q` from the frame's eye in a view, or with `place` 0 a direction.
vec4 abufferSeen(ViewData frame, float nearPlane, uint view, vec3 q, float place) {
    if (view > 0u) {
        vec3 seen = abufferFaceAxes(view - 1u, q);
        return vec4(seen.xy, vec2(seen.z + place * nearPlane));
    }
    vec4 clip = frame.viewProjection * vec4(q, 0.0);
    if (frame.position.w != 0.0) clip += place * (frame.viewProjection * vec4(frame.position.xyz, 1.0));
    return vec4(clip.xyw, -(frame.view * vec4(q, 0.0)).z);
}

ABufferRay abufferRay(ViewData frame, float nearPlane, uint view, vec3 origin, vec3 direction) {
    return ABufferRay(abufferSeen(frame, nearPlane, view, origin, 1.0), abufferSeen(frame, nearPlane, view, direction, 0.0));
}

ivec2 abufferSize(ViewData frame, ABufferShape shape, uint view) { return view == 0u ? ivec2(frame.size) : ivec2(shape.side); }

// The size of a pixel at a depth.
float abufferFootprint(ViewData frame, ABufferShape shape, uint view, float depth) {
    if (view > 0u) return 2.0 / float(max(shape.side, 1)) * depth;
    float size = max(length(frame.rightward.xyz), length(frame.upward.xyz));
    return frame.position.w != 0.0 ? size : size * depth;
}

float abufferNear(ViewData frame, ABufferShape shape, uint view) { return view == 0u ? frame.nearPlane : shape.nearPlane; }

// By how much each of a view's planes is on the right side of a place: left, right, lower, upper.
vec4 abufferSides(vec4 p) { return vec4(p.z + p.x, p.z - p.x, p.z + p.y, p.z - p.y); }

// Rays begin on the near plane, as far as float can tell.
bool abufferContains(vec4 p, float nearPlane) {
    return all(greaterThanEqual(abufferSides(p), vec4(0.0))) && p.w >= 0.9999 * nearPlane;
}

// The time at which the ray leaves the view, after which it is on the wrong side of one of its planes.
float abufferLeaves(ABufferRay ray, float nearPlane) {
    vec4 grow = abufferSides(ray.add);
    vec4 times = mix(vec4(rayInfinity), -abufferSides(ray.at) / grow, lessThan(grow, vec4(0.0)));
    float byNear = ray.add.w < 0.0 ? (nearPlane - ray.at.w) / ray.add.w : rayInfinity;
    return min(min(min(times.x, times.y), min(times.z, times.w)), byNear);
}

// The time from which on it is on the right side of all planes that it comes from without.
float abufferArrives(ABufferRay ray, float nearPlane) {
    vec4 grow = abufferSides(ray.add);
    vec4 times = mix(vec4(0.0), -abufferSides(ray.at) / grow, greaterThan(grow, vec4(0.0)));
    float byNear = ray.add.w > 0.0 ? (nearPlane - ray.at.w) / ray.add.w : 0.0;
    return max(max(max(times.x, times.y), max(times.z, times.w)), byNear);
}

// Where a ray goes decides between faces, close to the eye: by less than what their frusta overlap there.
float abufferOnward(ABufferShape shape) { return 0.5 * shape.nearPlane; }

// The view that a ray is in at a time; `origin` counts from the frame's eye.
uint abufferViewAt(ViewData frame, ABufferShape shape, vec3 origin, vec3 direction, float t) {
    vec3 place = origin + t * direction;
    if (shape.mainView &&
        (shape.side == 0 || abufferContains(abufferSeen(frame, 0.0, 0u, place, 1.0), frame.nearPlane)))
        return 0u;
    return 1u + abufferFaceOf(place + abufferOnward(shape) * direction);
}

// The same for a ray whenever it is traced.
float abufferJitter(vec3 origin, vec3 direction) {
    uvec3 a = floatBitsToUint(origin);
    uvec3 b = floatBitsToUint(direction);
    return unitFloat(hashCombine(hashCombine(hashCombine(a.x, a.y), hashCombine(a.z, b.x)), hashCombine(b.y, b.z)));
}

// A ray from `view` on. Of the frame's view alone it may come in from without.
ABufferMarch abufferMarch(ViewData frame, ABufferShape shape, uint view, vec3 origin, vec3 direction, float tMin, float tMax) {
    ABufferMarch march;
    march.origin = origin;
    march.direction = direction;
    march.tMax = tMax;
    march.t = tMin;
    march.view = view;
    march.views = tMin <= tMax ? 8 : 0;
    march.jitter = abufferJitter(origin, direction);
    if (shape.side == 0)
        march.t = max(tMin, abufferArrives(abufferRay(frame, 0.0, 0u, origin, direction), frame.nearPlane));
    return march;
}

ivec2 abufferPixelAt(vec4 place, ivec2 size) {
    return clamp(ivec2(floor(clamp(place.xy / place.z * 0.5 + 0.5, 0.0, 1.0) * vec2(size))), ivec2(0), size - 1);
}

// Divides the rest of its way over the view, from march.t to its end, into at most `samples` parts, equal on the view's
// plane.
void abufferDivide(inout ABufferMarch march, int samples) {
    vec4 from = march.ray.at + march.t * march.ray.add;
    vec4 to = march.ray.at + march.end * march.ray.add;
    march.first = from.xy / from.z;
    // Without end it goes to its vanishing point; of parallel rays that is where it is.
    bool endless = march.end == rayInfinity;
    march.last = endless ? (march.ray.add.z != 0.0 ? march.ray.add.xy / march.ray.add.z : march.first) : to.xy / to.z;
    vec2 pixels = 0.5 * abs(march.last - march.first) * vec2(march.size);
    march.parts = int(clamp(ceil(max(pixels.x, pixels.y)), 1.0, float(samples)));
    march.part = 0;
}

// Into march.view.
void abufferEnter(inout ABufferMarch march, ViewData frame, ABufferShape shape, ABufferSteps steps) {
    march.ray = abufferRay(frame, shape.nearPlane, march.view, march.origin, march.direction);
    march.size = abufferSize(frame, shape, march.view);
    march.end = min(march.tMax, abufferLeaves(march.ray, abufferNear(frame, shape, march.view)));
    march.pixel = abufferPixelAt(march.ray.at + march.t * march.ray.add, march.size);
    march.way = ivec2(sign(march.ray.add.xy * march.ray.at.z - march.ray.at.xy * march.ray.add.z));
    march.inside = march.t < march.end;
    march.level = 0;
    --march.views;
    if (steps.samples > 0) abufferDivide(march, steps.samples);
}

// On from a view that has been left, to the next or to the ray's end.
void abufferTurn(inout ABufferMarch march, ABufferShape shape) {
    if (shape.side == 0 || march.t >= march.tMax || march.t == rayInfinity) {
        march.views = 0;
        return;
    }
    vec3 place = march.origin + (march.t + abufferOnward(shape)) * march.direction;
    if (march.view > 0u) {
        uint axis = (march.view - 1u) / 2u;
        if (axis == 0u) place.x = 0.0;
        if (axis == 1u) place.y = 0.0;
        if (axis == 2u) place.z = 0.0;
    }
    march.view = 1u + abufferFaceOf(place);
}

// When the ray meets the lines at these places of the view's plane.
vec2 abufferMeets(ABufferRay ray, vec2 at) { return (at * ray.at.z - ray.at.xy) / (ray.add.xy - at * ray.add.z); }

// When it meets the borders of these numbers, 0 the left or lower one of the view; never where it goes the other way,
// or comes to an end at its vanishing point before.
vec2 abufferTimes(ABufferMarch march, ivec2 border) {
    vec2 at = 2.0 * vec2(border) / vec2(march.size) - 1.0;
    vec2 towards = march.ray.add.xy - at * march.ray.add.z;
    return mix(vec2(rayInfinity), abufferMeets(march.ray, at), greaterThan(towards * vec2(march.way), vec2(0.0)));
}

// From march.t to `next`: the depths there. A ray without end goes out of every interval of depths.
void abufferUntil(inout ABufferMarch march, float next) {
    march.next = next;
    march.from = march.ray.at.w + march.t * march.ray.add.w;
    float beyond = march.ray.add.w > 0.0 ? 3.0e38 : (march.ray.add.w < 0.0 ? -3.0e38 : march.from);
    march.to = next < rayInfinity ? march.ray.at.w + next * march.ray.add.w : beyond;
}

// Looks ahead to the end of the pixel or block, or of the part.
void abufferAhead(inout ABufferMarch march, ABufferSteps steps) {
    if (steps.samples > 0) {
        vec2 sampled = mix(march.first, march.last, (float(march.part) + march.jitter) / float(march.parts));
        march.pixel = abufferPixelAt(vec4(sampled, 1.0, 0.0), march.size);
        vec2 times = abufferMeets(march.ray, mix(march.first, march.last, float(march.part + 1) / float(march.parts)));
        vec2 way = abs(march.last - march.first) * vec2(march.size);
        float met = way.x >= way.y ? times.x : times.y;
        bool ends = march.part + 1 >= march.parts || !(met < march.end);
        abufferUntil(march, ends ? march.end : max(march.t, met));
        return;
    }
    int shift = steps.levels > 1 ? 2 * march.level : 0;
    march.border = min(((march.pixel >> shift) + max(march.way, ivec2(0))) << shift, march.size);
    march.times = abufferTimes(march, march.border);
    abufferUntil(march, max(march.t, min(min(march.times.x, march.times.y), march.end)));
}

// The pixel of a block, entered through the pixel that march.pixel is, from which stepping through it would leave it
// along x or y at the time `met`: the place says nearly which, the times at which the borders about it are met say it
// exactly.
ivec2 abufferLeft(ABufferMarch march, int shift, bool alongX, float met) {
    ivec2 low = (march.pixel >> shift) << shift;
    ivec2 high = min(low + (1 << shift), march.size) - 1;
    ivec2 pixel = clamp(abufferPixelAt(march.ray.at + march.t * march.ray.add, march.size), low, high);
    for (int i = 0; i < 2; ++i) {
        ITERATION;
        vec2 ahead = abufferTimes(march, pixel + max(march.way, ivec2(0)));
        vec2 behind = abufferTimes(march, pixel + max(-march.way, ivec2(0)));
        // Of two borders that are met at once that of x comes first. One behind that is never met lies before the
        // start.
        bvec2 on = bvec2(ahead.x <= met, ahead.y < met);
        bvec2 back = bvec2(behind.x > met && behind.x < rayInfinity, behind.y >= met && behind.y < rayInfinity);
        pixel += march.way * (ivec2(on) - ivec2(back) * ivec2(not(on)));
        pixel = clamp(pixel, low, high);
    }
    return pixel;
}

// Over what abufferAhead() looked through.
void abufferCross(inout ABufferMarch march, ABufferSteps steps) {
    march.t = march.next;
    if (steps.samples > 0) {
        ++march.part;
        march.inside = march.part < march.parts && march.t < march.end;
        return;
    }
    bool alongX = march.times.x <= march.times.y;
    ivec2 pixel = march.pixel;
    int border = alongX ? march.border.x : march.border.y;
    if (steps.levels > 1) {
        int shift = 2 * march.level;
        if (march.level > 0) pixel = abufferLeft(march, shift, alongX, alongX ? march.times.x : march.times.y);
        // Up where a larger block begins.
        if (((border >> shift) & 3) == 0) march.level = min(march.level + 1, steps.levels - 1);
    }
    if (alongX) {
        pixel.x = border - (march.way.x > 0 ? 0 : 1);
    } else {
        pixel.y = border - (march.way.y > 0 ? 0 : 1);
    }
    march.pixel = pixel;
    march.inside = march.next < march.end && all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, march.size));
}

// Blocks of a level in all views; `mainSize`: pixels of the frame's view, if it is there.
int abufferBlocks(ABufferShape shape, ivec2 mainSize, int level) {
    ivec2 main = (mainSize + (1 << (2 * level)) - 1) >> (2 * level);
    int side = (shape.side + (1 << (2 * level)) - 1) >> (2 * level);
    return main.x * main.y + int(abufferFaces) * side * side;
}

// The number of the block, or pixel, that the ray is in: level 0 of all views comes first, then level 1 of all, and so
// on up to level 3, each view in rows.
int abufferBlock(ABufferMarch march, ABufferShape shape, ivec2 mainSize) {
    int first = (march.level > 0 ? abufferBlocks(shape, mainSize, 0) : 0) +
                (march.level > 1 ? abufferBlocks(shape, mainSize, 1) : 0) +
                (march.level > 2 ? abufferBlocks(shape, mainSize, 2) : 0);
    int shift = 2 * march.level;
    ivec2 main = (mainSize + (1 << shift) - 1) >> shift;
    int side = (shape.side + (1 << shift) - 1) >> shift;
    ivec2 at = march.pixel >> shift;
    if (march.view == 0u) return first + at.y * main.x + at.x;
    return first + main.x * main.y + (int(march.view - 1u) * side + at.y) * side + at.x;
}
