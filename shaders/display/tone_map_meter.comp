// Sums of the logarithms of luminance, of a column of METER_ROWS pixels each: as whole numbers, so that the sum of all
// is the same in whatever order it is made.
layout(local_size_x = 64) in;

layout(COLOUR_FORMAT) uniform readonly image2D colour;
// x: of 65536 (log2(luminance) + 160); y: of pixels.
layout(std430) writeonly buffer Sums { uvec2 sums[]; };

// 65536 log2(value): exact in the whole stops, so that light of twice the strength counts 65536 more to the bit. Below
// 2^-100 nothing is seen, and infinities and what is no number do not count: then 0.
uint biasedLogarithm(float value) {
    uint bits = floatBitsToUint(value);
    int exponent = int(bits >> 23) - 127;
    if (exponent < -100 || exponent > 127) return 0u;
    float mantissa = uintBitsToFloat((bits & 0x007fffffu) | 0x3f800000u); // in [1, 2)
    return uint((exponent + 160) * 65536 + int(log2(mantissa) * 65536.0 + 0.5));
}

// Infinite or no number at all: looked at as bits, since comparing need not tell.
bool isStrange(vec3 c) { return any(greaterThanEqual(floatBitsToUint(c) & 0x7fffffffu, uvec3(0x7f800000u))); }

void main() {
    ivec2 size = imageSize(colour);
    ivec2 strip = ivec2(gl_GlobalInvocationID.xy);
    if (strip.x >= size.x || strip.y * METER_ROWS >= size.y) return;
    uvec2 sum = uvec2(0);
    for (int i = 0; i < METER_ROWS; ++i) {
        int y = strip.y * METER_ROWS + i;
        if (y >= size.y) break;
        vec3 c = imageLoad(colour, ivec2(strip.x, y)).rgb;
#ifdef GREY
        c = c.rrr;
#endif
        uint logarithm = isStrange(c) ? 0u : biasedLogarithm(dot(max(c, vec3(0.0)), vec3(0.2126, 0.7152, 0.0722)));
        if (logarithm != 0u) sum += uvec2(logarithm, 1u);
    }
    sums[strip.y * size.x + strip.x] = sum;
}
