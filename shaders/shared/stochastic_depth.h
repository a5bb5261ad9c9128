// Stochastic depth maps: where a texel's samples are taken, and which slots a surface is kept in. The same numbers on both
// sides of the C++/GLSL border.
#pragma once
#include "shared/random.h"

SHARED_BEGIN

// How much further away than the first surface a depth must be to lie behind it, relative to its distance: above what
// rasterizer and rays differ by, far below what occlusion tells apart.
const float depthSeparation = 4.8828125e-4f; // 2^-11

// Within the texel, in [0, 1)^2: of 4 x 4 texels the first 16 points of the Sobol sequence, one in each row and column of
// the 16 x 16 grid (Brüll, Kern, Grosch 2024, figure 5). Which texel has which the paper leaves open: here each column of
// texels has a point in every quarter of their width, and each row in every quarter of their height, so that no edge
// passes a whole row or column at once. `texel` counts from the frame's corner, guard band excluded.
inline vec2 sobolJitter(ivec2 texel) {
    uint index = uint(((texel.x + texel.y) & 3) + 4 * (texel.y & 3));
    vec2 point = vec2(unitFloat(reverseBits32(index)), unitFloat(reverseBits32(reversedSobol1(index))));
    return point + vec2(0.03125f, 0.03125f);
}

// A texel has so many cells per axis, each a bit: which of them samples fall into.
const int depthCellsAcross = 4;
const int depthCells = depthCellsAcross * depthCellsAcross;

inline ivec2 depthCellAt(int bit) { return ivec2(bit % depthCellsAcross, bit / depthCellsAcross); }
// `cell` counts from the map's corner.
inline uint depthCellBit(ivec2 cell) {
    return 1u << uint(cell.x % depthCellsAcross + depthCellsAcross * (cell.y % depthCellsAcross));
}

inline uint binomial(uint n, uint k) {
    uint result = 1u;
    for (uint i = 1u; i <= k; ++i) result = result * (n + 1u - i) / i;
    return k <= n ? result : 0u;
}

// Of all masks of `slots` bits, sorted by their number of bits and then as numbers, how many come before those of `bits`
// bits (Enderton, Sintorn, Shirley, Luebke, "Stochastic Transparency", 2010, section 4.2).
inline uint firstMask(uint slots, uint bits) {
    uint first = 0u;
    for (uint k = 0u; k < bits; ++k) first += binomial(slots, k);
    return first;
}

// The mask at `index` of those of `bits` bits in that order.
inline uint maskAt(uint slots, uint bits, uint index) {
    uint mask = 0u;
    for (uint slot = slots; slot > 0u && bits > 0u; --slot) {
        uint without = binomial(slot - 1u, bits);
        if (index < without) continue;
        index -= without;
        mask |= 1u << (slot - 1u);
        --bits;
    }
    return mask;
}

// The slots of a surface of opacity `alpha`: alpha * slots bits in the mean, chosen by two numbers in [0, 1).
inline uint coverageMask(uint slots, float alpha, float chance, float choice) {
    uint bits = min(uint(alpha * float(slots) + chance), slots);
    uint count = binomial(slots, bits);
    return maskAt(slots, bits, min(uint(choice * float(count)), count - 1u));
}

// At which one or two samples keep a surface (Brüll, Kern, Grosch 2022).
inline float coverageAlpha(uint slots) { return 1.5f / float(slots); }

SHARED_END
