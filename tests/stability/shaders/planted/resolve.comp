layout(local_size_x = 8, local_size_y = 8) in;

layout(r32ui) uniform readonly uimage2D nearest;
layout(r32f) uniform writeonly image2D result;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(result)))) return;
    imageStore(result, pixel, vec4(uintBitsToFloat(imageLoad(nearest, pixel).r)));
}
