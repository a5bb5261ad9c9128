// A ray's way through the pixels of an A-buffer's views (Vardis, Vasilakis, Papaioannou 2016, section 3.4): what the modules
// for fragments and for primitives share. What differs from the paper, and why:
//
//   - A ray passes from pixel to pixel at the times at which it meets the planes through the eye and the pixels' borders, each
//     worked out by itself and never summed up: nothing drifts, tMin and tMax are times too, and the times that a ray spends
//     in its pixels lie end to end, whatever the view.
//   - Views are left by edge connectivity in one form for all borders, the near plane too: the axis of the face that is left
//     counts no more, and the largest of the other components of the place says which face comes next.
//
// Positions count from the frame's eye, so that nothing is lost where the scene lies far from the origin.
#include "lib/tracer.glsl"
#include "lib/iterations.glsl"
#include "shared/abuffer.h"
#include "shared/view.h"

// Which views there are: the frame's (0), and with a side the six faces of the cube (1 + face).
struct ABufferShape {
    bool mainView;
    int side;
    float nearPlane; // of the cube
};
// By a module's own defines.
#define ABUFFER_SHAPE ABufferShape(MAIN_PIXELS > 0, SIDE, NEAR_PLANE)

// A ray in a view: x, y, w of clip space and the depth along the view's axis, each at time 0 and what a unit of time adds.
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
    // In the pixel, or in a block of pixels: the times at which it meets the borders ahead, when it leaves, and its depths.
    ivec2 border;
    vec2 times;
    float next;
    float from;
    float to;
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

bool abufferContains(vec4 p, float nearPlane) { return all(greaterThanEqual(abufferSides(p), vec4(0.0))) && p.w >= nearPlane; }

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

// A ray from `view` on. Of the frame's view alone it may come in from without.
ABufferMarch abufferMarch(ViewData frame, ABufferShape shape, uint view, vec3 origin, vec3 direction, float tMin, float tMax) {
    ABufferMarch march;
    march.origin = origin;
    march.direction = direction;
    march.tMax = tMax;
    march.t = tMin;
    march.view = view;
    march.views = tMin <= tMax ? 8 : 0;
    if (shape.side == 0)
        march.t = max(tMin, abufferArrives(abufferRay(frame, 0.0, 0u, origin, direction), frame.nearPlane));
    return march;
}

ivec2 abufferPixelAt(vec4 place, ivec2 size) {
    return clamp(ivec2(floor(clamp(place.xy / place.z * 0.5 + 0.5, 0.0, 1.0) * vec2(size))), ivec2(0), size - 1);
}

// Into march.view.
void abufferEnter(inout ABufferMarch march, ViewData frame, ABufferShape shape) {
    march.ray = abufferRay(frame, shape.nearPlane, march.view, march.origin, march.direction);
    march.size = abufferSize(frame, shape, march.view);
    march.end = min(march.tMax, abufferLeaves(march.ray, abufferNear(frame, shape, march.view)));
    march.pixel = abufferPixelAt(march.ray.at + march.t * march.ray.add, march.size);
    march.way = ivec2(sign(march.ray.add.xy * march.ray.at.z - march.ray.at.xy * march.ray.add.z));
    march.inside = march.t < march.end;
    --march.views;
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

// When the ray meets the borders of these numbers, 0 the left or lower one of the view; never where it goes the other way, or
// comes to an end at its vanishing point before.
vec2 abufferTimes(ABufferMarch march, ivec2 border) {
    vec2 at = 2.0 * vec2(border) / vec2(march.size) - 1.0;
    vec2 towards = march.ray.add.xy - at * march.ray.add.z;
    return mix(vec2(rayInfinity), (at * march.ray.at.z - march.ray.at.xy) / towards,
               greaterThan(towards * vec2(march.way), vec2(0.0)));
}

// From march.t to `next`: the depths there. A ray without end goes out of every interval of depths.
void abufferUntil(inout ABufferMarch march, float next) {
    march.next = next;
    march.from = march.ray.at.w + march.t * march.ray.add.w;
    float beyond = march.ray.add.w > 0.0 ? 3.0e38 : (march.ray.add.w < 0.0 ? -3.0e38 : march.from);
    march.to = next < rayInfinity ? march.ray.at.w + next * march.ray.add.w : beyond;
}

// Looks ahead to the end of the pixel, or of its block of 4^level times 4^level pixels.
void abufferAhead(inout ABufferMarch march, int level) {
    int shift = 2 * level;
    march.border = min(((march.pixel >> shift) + max(march.way, ivec2(0))) << shift, march.size);
    march.times = abufferTimes(march, march.border);
    abufferUntil(march, max(march.t, min(min(march.times.x, march.times.y), march.end)));
}

// To the next pixel.
void abufferCross(inout ABufferMarch march) {
    march.t = march.next;
    if (march.times.x <= march.times.y) {
        march.pixel.x += march.way.x;
    } else {
        march.pixel.y += march.way.y;
    }
    march.inside = march.next < march.end && all(greaterThanEqual(march.pixel, ivec2(0))) && all(lessThan(march.pixel, march.size));
}

// Out of the block that abufferAhead() looked through, into the very pixel that stepping through it would lead to: the place
// says nearly which, the times at which the borders about it are met say it exactly.
void abufferCrossBlock(inout ABufferMarch march, int level) {
    int shift = 2 * level;
    ivec2 low = (march.pixel >> shift) << shift;
    ivec2 high = min(low + (1 << shift), march.size) - 1;
    bool alongX = march.times.x <= march.times.y;
    float met = alongX ? march.times.x : march.times.y;
    march.t = march.next;
    march.inside = march.next < march.end;
    if (!march.inside) return;
    ivec2 pixel = clamp(abufferPixelAt(march.ray.at + march.t * march.ray.add, march.size), low, high);
    for (int i = 0; i < 2; ++i) {
        ITERATION;
        vec2 ahead = abufferTimes(march, pixel + max(march.way, ivec2(0)));
        vec2 behind = abufferTimes(march, pixel + max(-march.way, ivec2(0)));
        // Of two borders that are met at once that of x comes first. One behind that is never met lies before the start.
        bvec2 on = bvec2(ahead.x <= met, ahead.y < met);
        bvec2 back = bvec2(behind.x > met && behind.x < rayInfinity, behind.y >= met && behind.y < rayInfinity);
        pixel += march.way * (ivec2(on) - ivec2(back) * ivec2(not(on)));
        pixel = clamp(pixel, low, high);
    }
    march.pixel = alongX ? ivec2(march.way.x > 0 ? march.border.x : march.border.x - 1, pixel.y)
                         : ivec2(pixel.x, march.way.y > 0 ? march.border.y : march.border.y - 1);
    march.inside = all(greaterThanEqual(march.pixel, ivec2(0))) && all(lessThan(march.pixel, march.size));
}
