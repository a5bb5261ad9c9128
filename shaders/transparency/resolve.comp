// Equation 6 of the paper: the weighted mean of the colours over what is opaque, by what all of them let through.
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D picture;
uniform sampler2D weighted;
uniform sampler2D through;
layout(rgba32f) uniform writeonly image2D result;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(result)))) return;
    vec4 sum = texelFetch(weighted, pixel, 0);
    float revealed = exp(texelFetch(through, pixel, 0).r);
    vec4 behind = texelFetch(picture, pixel, 0);
    vec3 mean = sum.a > 0.0 ? sum.rgb / sum.a : vec3(0.0);
    vec3 light = mean * (1.0 - revealed) + behind.rgb * revealed;
    imageStore(result, pixel, vec4(min(light, vec3(1e30)), 1.0 - revealed * (1.0 - behind.a)));
}
