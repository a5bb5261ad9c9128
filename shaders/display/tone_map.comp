// OPERATOR: 0 linear, 1 Reinhard (on luminance), 2 ACES.
layout(local_size_x = 8, local_size_y = 8) in;

layout(COLOUR_FORMAT) uniform readonly image2D colour;
layout(rgba8) uniform writeonly image2D image;
#ifdef METERED
layout(std430) readonly buffer Metered {
    float average;
    float factor; // on light
    uint seen, pixels;
};
#else
uniform float exposure; // factor
#endif

vec3 toneMapped(vec3 c) {
#if OPERATOR == 1
    return c / (1.0 + dot(c, vec3(0.2126, 0.7152, 0.0722)));
#elif OPERATOR == 2
    return c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14);
#else
    return c;
#endif
}

vec3 encoded(vec3 c) {
    return mix(12.92 * c, 1.055 * pow(max(c, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(image)))) return;
    vec4 sampled = imageLoad(colour, pixel);
#ifdef GREY
    sampled = vec4(sampled.rrr, 1.0);
#endif
    // Beyond 2^40 the ACES quotient would be infinity over infinity; the curves have long reached 1 there.
#ifdef METERED
    float exposure = factor;
#endif
    vec3 c = clamp(sampled.rgb * exposure, 0.0, 1.0995e12);
    c = clamp(toneMapped(c), 0.0, 1.0);
#ifdef ENCODE
    c = encoded(c);
#endif
    imageStore(image, pixel, vec4(c, 1.0));
}
