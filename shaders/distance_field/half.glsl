// The nearest 16-bit float to a value that is 0 or in the range of normal ones, ties to even. Drivers may truncate on
// storing; what is one already is stored as it is.
float nearestHalf(float value) {
    uint bits = floatBitsToUint(value);
    return uintBitsToFloat((bits + 0xfffu + (bits >> 13u & 1u)) & ~0x1fffu);
}
