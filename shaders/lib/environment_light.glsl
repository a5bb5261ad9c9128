// Light from the surroundings by direction. Programs and modules choose the kind by GRADIENT, PICTURE or neither.
#include "lib/sampling.glsl"
#include "shared/environment.h"

// Where in a picture of all directions unit `direction` lies: longitude from +z over +x along x, latitude along y.
vec2 environmentCoordinate(vec3 direction, float rotation) {
    float longitude = atan(direction.x, direction.z) + rotation;
    float latitude = asin(clamp(direction.y, -1.0, 1.0));
    return vec2(fract(0.5 + longitude / (2.0 * pi)), 0.5 + latitude / pi);
}
