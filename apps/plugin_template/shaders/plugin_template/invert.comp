// Names are the ports' names; nobody writes a binding number.
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D signal;
layout(rgba32f) uniform writeonly image2D result;
uniform float scale;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(result)))) return;
    imageStore(result, pixel, (1.0 - texelFetch(signal, pixel, 0)) * scale);
}
