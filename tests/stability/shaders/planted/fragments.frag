// An atomic maximum of the first eight fragments; what comes after is dropped without a word.
layout(r32ui) uniform uimage2D counts;
layout(r32ui) uniform uimage2D nearest;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    if (imageAtomicAdd(counts, pixel, 1u) < 8u) imageAtomicMax(nearest, pixel, floatBitsToUint(gl_FragCoord.z));
}
