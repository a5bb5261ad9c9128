// What a shader knows of the frame and of the view that an image was made with; the same layout (std140) on both sides.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

// The reserved uniform block `Frame`, bound to every program that declares it.
struct FrameData {
    uvec2 size;     // of the frame, pixels
    uint index;     // frame index; with `seed` the only source of randomness
    uint seed;
    float time;     // seconds
    uint pad0;
    uint pad1;
    uint pad2;
    vec4 sceneBounds; // bounding sphere of the scene over its timeline: centre, radius; render space
};

// A uniform block `<Port>View` receives the view of that port's image.
struct ViewData {
    mat4 view;               // render space -> eye space
    mat4 projection;         // eye space -> clip space, reversed z in [0, 1], jitter and guard band included
    mat4 viewProjection;
    mat4 inverseView;
    mat4 inverseProjection;
    mat4 inverseViewProjection;
    mat4 previousViewProjection; // of the last frame, without its jitter
    vec4 position;           // of the eye, render space; w: 1 if orthographic
    uvec2 size;              // of the image, pixels, guard band included
    uint guard;              // pixels of this image on each side
    uint divisor;
    vec2 jitter;             // pixels of this image, in [-0.5, 0.5]
    float nearPlane;
    float farPlane;          // 0: infinite
    // Where a pixel coordinate's surface lies in render space, in a few numbers (positionFromDepth() of lib/view.glsl): the
    // way from `position` at viewing depth 1, at pixel coordinate (0, 0), and what a pixel to the right and one up adds. Of
    // parallel rays the way holds at every depth, and `ahead` is their direction; of others it is zero.
    vec4 corner; // .w of these four: the viewing depth is (corner.w d + rightward.w) / (upward.w d + ahead.w) of depth d
    vec4 rightward;
    vec4 upward;
    vec4 ahead;
};

SHARED_END
