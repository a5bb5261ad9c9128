// Triangles of the frame's view, wider on all sides by what a rasterizer may round corners by: each pixel whose ray
// meets one has a fragment of it, and whether the ray does is for the fragment to say (abuffer/fragment.glsl).
#include "shared/view.h"

layout(triangles) in;
layout(triangle_strip, max_vertices = 4) out;

layout(std140) uniform VIEW_BLOCK { ViewData frameView; };

#ifdef BY_NUMBER
flat in uint corner_triangle[];
flat out uint seen_triangle;
#endif

// No device has fewer bits below the pixel than four; in parts of half the image.
vec2 roomOnScreen() { return 2.0 / (16.0 * vec2(frameView.size)); }

void emit(vec3 place) {
#ifdef BY_NUMBER
    seen_triangle = corner_triangle[0];
#else
    gl_PrimitiveID = gl_PrimitiveIDIn;
#endif
    // In the middle of the depths: the ray's interval tells what is before the near plane and behind the far one, and
    // what is behind the eye is clipped.
    gl_Position = vec4(place.xy, 0.5 * place.z, place.z);
    EmitVertex();
}

void main() {
    vec3 p[3];
    for (int i = 0; i < 3; ++i) p[i] = gl_in[i].gl_Position.xyw;
    // Edges as planes through the eye (Hasselgren, Akenine-Moller and Ohlsson, "Conservative Rasterization", GPU Gems
    // 2, 2005), moved outwards; corners are where neighbours meet.
    vec3 edge[3];
    for (int i = 0; i < 3; ++i) edge[i] = cross(p[(i + 1) % 3], p[(i + 2) % 3]);
    float side = dot(p[0], edge[0]) < 0.0 ? -1.0 : 1.0;
    vec2 room = roomOnScreen();
    for (int i = 0; i < 3; ++i) {
        edge[i] *= side;
        edge[i].z += dot(room, abs(edge[i].xy));
    }
    vec3 corner[3];
    bool alike = true;
    for (int i = 0; i < 3; ++i) {
        corner[i] = side * cross(edge[(i + 1) % 3], edge[(i + 2) % 3]);
        alike = alike && (corner[i].z > 0.0) == (p[i].z > 0.0);
    }
    bool before = p[0].z > 0.0 && p[1].z > 0.0 && p[2].z > 0.0;
    if (before && !alike) {
        // The moved edges of a sliver meet far away or not at all: the rectangle about it.
        vec2 a = p[0].xy / p[0].z;
        vec2 b = p[1].xy / p[1].z;
        vec2 c = p[2].xy / p[2].z;
        vec2 low = max(min(a, min(b, c)) - room, vec2(-1.0));
        vec2 high = min(max(a, max(b, c)) + room, vec2(1.0));
        emit(vec3(low, 1.0));
        emit(vec3(high.x, low.y, 1.0));
        emit(vec3(low.x, high.y, 1.0));
        emit(vec3(high, 1.0));
    } else {
        for (int i = 0; i < 3; ++i) emit(corner[i]);
    }
    EndPrimitive();
}
