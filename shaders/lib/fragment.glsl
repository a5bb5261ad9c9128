// What a fragment of drawScene knows of its triangle.
#include "lib/scene.glsl"

uniform uint scene_first_triangle;

// The triangle's number in the scene.
uint fragmentTriangle() { return scene_first_triangle + uint(gl_PrimitiveID); }

uint fragmentMaterial() { return sceneTriangle(fragmentTriangle()).w; }

// Call it before any branch: derivatives are undefined behind one.
TexCoords fragmentTexCoords(vec2 first, vec2 second) {
    return TexCoords(first, second, dFdx(first), dFdy(first), dFdx(second), dFdy(second));
}
