// What a fragment of drawScene knows of its triangle.
#include "lib/material.glsl"

layout(rgba32ui) uniform readonly uimageBuffer scene_triangles;
uniform uint scene_first_triangle;

// The triangle's number in the scene.
uint fragmentTriangle() { return scene_first_triangle + uint(gl_PrimitiveID); }

uint fragmentMaterial() { return imageLoad(scene_triangles, int(fragmentTriangle())).w; }

// Call it before any branch: derivatives are undefined behind one.
TexCoords fragmentTexCoords(vec2 first, vec2 second) {
    return TexCoords(first, second, dFdx(first), dFdy(first), dFdx(second), dFdy(second));
}
