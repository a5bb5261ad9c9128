// A level of the field: the mean of the eight cells of the level below.
#include "distance_field/half.glsl"

layout(local_size_x = 16, local_size_y = 4) in;

layout(r16f) readonly uniform image3D field;
layout(r16f) writeonly uniform image3D field_out;

void main() {
    ivec3 cell = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(cell, imageSize(field_out)))) return;
    float sum = 0.0;
    for (int i = 0; i < 8; ++i) sum += imageLoad(field, 2 * cell + ivec3(i & 1, i >> 1 & 1, i >> 2)).x;
    imageStore(field_out, cell, vec4(nearestHalf(0.125 * sum)));
}
