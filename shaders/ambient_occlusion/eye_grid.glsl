// From pixels of a view depth to eye space and back, in few operations.
#include "lib/view.glsl"

// Pixel coordinates of an image: axis + perUnit * xy / depth, or of a parallel projection axis + perUnit * xy.
struct EyeGrid {
    vec2 axis, perUnit, unitsPer;
    bool parallel;
};

EyeGrid eyeGrid(ViewData view) {
    bool parallel = view.position.w != 0.0;
    vec2 half_ = 0.5 * vec2(view.size);
    vec2 perUnit = half_ * vec2(view.projection[0].x, view.projection[1].y);
    vec2 shift = parallel ? view.projection[3].xy : -view.projection[2].xy;
    return EyeGrid(half_ * (1.0 + shift), perUnit, 1.0 / perUnit, parallel);
}

vec3 eyePosition(EyeGrid grid, vec2 place, float depth) {
    return vec3((place - grid.axis) * grid.unitsPer * (grid.parallel ? 1.0 : depth), -depth);
}

// A depth of 0 stands for nothing: as far away as numbers whose squares are finite allow.
float depthOrFar(float depth) { return depth > 0.0 ? depth : 1e15; }
