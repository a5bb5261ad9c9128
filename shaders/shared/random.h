// Random numbers as functions of (pixel, frame, dimension): no running state, so leaving out one consumer of numbers
// never changes another. The same bits on both sides of the C++/GLSL border.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

// Named dimensions: one pair per use, so that two uses never share numbers by accident.
const uint randomRayDirection = 0u; // two a ray: 2 * ray index is added
const uint randomCandidates = 1024u;
const uint randomGridJitter = 1025u;
const uint randomLight = 2048u;
const uint randomReference = 4096u;
const uint randomIndirect = 8192u;   // like randomRayDirection: two a ray
const uint randomShadow = 12288u;    // two a ray, for the point on the light
const uint randomGlossy = 16384u;    // two a ray
const uint randomLightJitter = 20480u; // of the positions of lights, per light
const uint randomGather = 20992u;    // of samples of a reflective shadow map
const uint randomScreenTrace = 21504u; // where between its samples a march begins
const uint randomPath = 24576u; // of paths: four a bounce (shaders/ray_effects/path.glsl)
const uint randomStochasticDepth = 22016u; // which depths a texel keeps; the hit's number is hashed in

// Integer hash with good avalanche (multiply, xor-shift; constants found by search, "lowbias32").
inline uint hashUint(uint x) {
    x ^= x >> 16u;
    x *= 0x7feb352du;
    x ^= x >> 15u;
    x *= 0x846ca68bu;
    x ^= x >> 16u;
    return x;
}

inline uint hashCombine(uint a, uint b) { return hashUint(a ^ (b + 0x9e3779b9u + (a << 6u) + (a >> 2u))); }

// [0, 1) from the 24 high bits: exact in float, never 1.
inline float unitFloat(uint bits) { return float(bits >> 8u) * 5.9604644775390625e-8f; }

inline uint reverseBits32(uint x) {
    x = (x << 16u) | (x >> 16u);
    x = ((x & 0x00ff00ffu) << 8u) | ((x & 0xff00ff00u) >> 8u);
    x = ((x & 0x0f0f0f0fu) << 4u) | ((x & 0xf0f0f0f0u) >> 4u);
    x = ((x & 0x33333333u) << 2u) | ((x & 0xccccccccu) >> 2u);
    return ((x & 0x55555555u) << 1u) | ((x & 0xaaaaaaaau) >> 1u);
}

// Owen scrambling of a bit-reversed number as a hash in which higher bits depend only on lower ones
// (Laine and Karras, "Stratified Sampling for Stochastic Transparency", 2011, section 3).
inline uint laineKarras(uint x, uint seed) {
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

inline uint owenScramble(uint x, uint seed) { return reverseBits32(laineKarras(reverseBits32(x), seed)); }

// Second dimension of the Sobol sequence, its bits reversed; the first, reversed, is the index itself. Its matrix is
// Pascal's triangle modulo 2, where an entry (k, j) is odd if the bits of j are among those of k: so each bit is the sum of
// those whose places contain its own, which five steps add up for all bits at once.
inline uint reversedSobol1(uint index) {
    uint x = index;
    x ^= (x & 0xaaaaaaaau) >> 1u;
    x ^= (x & 0xccccccccu) >> 2u;
    x ^= (x & 0xf0f0f0f0u) >> 4u;
    x ^= (x & 0xff00ff00u) >> 8u;
    x ^= x >> 16u;
    return x;
}

// Sample `index` of the (0,2)-sequence that belongs to `seed`: shuffled and Owen-scrambled Sobol points (Burley,
// "Practical Hash-based Owen Scrambling", 2020). Any 2^k consecutive samples from a multiple of 2^k are stratified.
inline vec2 scrambledSobol(uint index, uint seed) {
    uint shuffled = owenScramble(index, seed);
    // Owen scrambling without turning the bits round and back in between.
    uint x = reverseBits32(laineKarras(shuffled, hashCombine(seed, 1u)));
    uint y = reverseBits32(laineKarras(reversedSobol1(shuffled), hashCombine(seed, 2u)));
    return vec2(unitFloat(x), unitFloat(y));
}

inline uint pixelSeed(uvec2 pixel, uint dimension, uint seed) {
    return hashCombine(hashCombine(hashCombine(seed, pixel.x), pixel.y), dimension);
}

SHARED_END
