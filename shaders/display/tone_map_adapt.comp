// The exposure of this frame: the mean of the logarithms, towards which the last frame's exposure moves.
layout(local_size_x = 256) in;

layout(std430) readonly buffer Sums { uvec2 sums[]; };
layout(std430) buffer Metered {
    float average; // log2 of luminance that the exposure is for
    float factor;  // on light
    uint seen;     // 1: average is of a frame that had light in it
    uint pixels;   // that counted in this frame
};
uniform int strips;
uniform int restart;    // 1: whatever was seen before does not count
uniform float rate;     // share of the way to this frame's average, in stops
uniform float key;      // what a picture's average becomes
uniform float exposure; // stops besides

shared uvec3 partial[256]; // low and high word of the sum of logarithms, pixels

uvec3 added(uvec3 a, uvec3 b) {
    uint carry;
    uint low = uaddCarry(a.x, b.x, carry);
    return uvec3(low, a.y + b.y + carry, a.z + b.z);
}

// The sum by the number of pixels, rounded down, in whole numbers: a float of the sum would have too few bits. The
// quotient has at most 25 bits.
uint meanOf(uvec3 sum) {
    uint quotient = 0u;
    for (int bit = 25; bit >= 0; --bit) {
        uint high, low, borrow;
        umulExtended(sum.z, 1u << bit, high, low);
        if (high > sum.y || (high == sum.y && low > sum.x)) continue;
        sum.x = usubBorrow(sum.x, low, borrow);
        sum.y = sum.y - high - borrow;
        quotient |= 1u << bit;
    }
    return quotient;
}

void main() {
    uint own = gl_LocalInvocationID.x;
    uvec3 sum = uvec3(0);
    for (uint i = own; i < uint(strips); i += 256u) sum = added(sum, uvec3(sums[i].x, 0u, sums[i].y));
    partial[own] = sum;
    for (uint apart = 128u; apart > 0u; apart >>= 1) {
        barrier();
        if (own < apart) partial[own] = added(partial[own], partial[own + apart]);
    }
    if (own != 0u) return;

    sum = partial[0];
    bool known = restart == 0 && seen == 1u;
    pixels = sum.z;
    if (sum.z > 0u) {
        float measured = float(int(meanOf(sum)) - 160 * 65536) / 65536.0;
        average = known && rate < 1.0 ? average + (measured - average) * rate : measured;
        seen = 1u;
    } else if (!known) { // black: as it is
        average = log2(key);
        seen = 0u;
    }
    // Whole stops by the exponent alone, so that they are exact; within what a float holds.
    float whole = floor(average);
    factor = ldexp(key * exp2(exposure) * exp2(whole - average), -int(clamp(whole, -94.0, 80.0)));
}
