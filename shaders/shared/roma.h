// The candidate directions of a ray-aligned occupancy map array, and the strata that they are drawn from.
//
// n x n squares of the unit square, each with one candidate in it, are mapped to the disk by the concentric map (Shirley
// and Chiu, "A Low Distortion Map Between Disk and Square", 1997) and from there to the hemisphere z >= 0, both times
// preserving fractional areas: every stratum has the solid angle 2 pi / n^2. A map serves both ways along its axis.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

// A candidate in the uniform block `Directions` (std140), index y * n + x of its stratum (x, y). Ahead of the candidates
// stand the OccupancySettings.
struct RomaDirection {
    vec3 direction;   // unit, z >= 0: the z axis of the rotated map
    float spreadXX;   // covariance of the stratum's directions
    vec3 mean;        // of the stratum's directions: their plain average, shorter than 1
    float spreadYY;
    float spreadZZ;
    float spreadXY;
    float spreadXZ;
    float spreadYZ;
};

// A rotated map's axes in the uniform block `Rotations` (std140): half a cell's step along each of them, in the base
// map's cells as fixed-point numbers. Integers, so that rotating gives the same bits on every machine.
struct RomaRotation {
    ivec4 halfX;
    ivec4 halfY;
    ivec4 halfZ;
};

// Fractional bits of a fixed-point cell coordinate. The corners of a rotated cube of 256 cells lie within 128 +- 222 of
// the base map's corner: 10 bits with sign, 22 remain.
const int romaFractionBits = 22;
const int romaMaxDirections = 256;

// The x and y axis of the rotated map with unit z axis w, w.z >= 0 (Duff et al., "Building an Orthonormal Basis,
// Revisited", 2017, for the half where their sign is 1).
inline vec3 romaAxisX(vec3 w) {
    float a = -1.0f / (1.0f + w.z);
    return vec3(1.0f + w.x * w.x * a, w.x * w.y * a, -w.x);
}
inline vec3 romaAxisY(vec3 w) {
    float a = -1.0f / (1.0f + w.z);
    return vec3(w.x * w.y * a, 1.0f + w.y * w.y * a, -w.y);
}

// 4 / pi * atan(t) for t in [0, 1]: an odd polynomial fitted for the least maximum error, 5e-7 in float arithmetic.
inline float octantAngle(float t) {
    float s = t * t;
    float p = 0.00867301412f;
    p = p * s - 0.0427861363f;
    p = p * s + 0.101379924f;
    p = p * s - 0.168492109f;
    p = p * s + 0.252200931f;
    p = p * s - 0.424209893f;
    p = p * s + 1.27323461f;
    return p * t;
}

// The point of the unit square that is mapped to unit direction d, d.z >= 0: the inverse of the two maps.
inline vec2 squareFromHemisphere(vec3 d) {
    // On the disk the radius squared is 1 - z. Dividing x and y by sqrt(1 + z) gets there without cancellation.
    float shrink = 1.0f / sqrt(1.0f + d.z);
    float x = d.x * shrink;
    float y = d.y * shrink;
    float radius = sqrt(x * x + y * y);
    bool wide = abs(x) > abs(y);
    float major = max(abs(x), abs(y));
    float minor = radius * octantAngle(major > 0.0f ? min(abs(x), abs(y)) / major : 0.0f);
    float px = wide ? radius : minor;
    float py = wide ? minor : radius;
    return vec2(0.5f + 0.5f * (x < 0.0f ? -px : px), 0.5f + 0.5f * (y < 0.0f ? -py : py));
}

// Index of the stratum of unit direction d, d.z >= 0, out of n x n: constant time. As squareFromHemisphere(), by one root
// less: the disk's point itself is not needed.
inline int stratumOf(vec3 d, int n) {
    float ax = abs(d.x);
    float ay = abs(d.y);
    float major = max(ax, ay);
    float radius = sqrt((ax * ax + ay * ay) / (1.0f + d.z));
    float minor = radius * octantAngle(major > 0.0f ? min(ax, ay) / major : 0.0f);
    float px = ax > ay ? radius : minor;
    float py = ax > ay ? minor : radius;
    float half_ = 0.5f * float(n);
    int x = clamp(int(half_ + half_ * (d.x < 0.0f ? -px : px)), 0, n - 1);
    int y = clamp(int(half_ + half_ * (d.y < 0.0f ? -py : py)), 0, n - 1);
    return y * n + x;
}

// The mean of max(0, normal . w) over a stratum, from the mean `a` and the variance of normal . w there: exactly that of
// the density 3/4 (1 - e^2), scaled to that mean and variance. Exact where the stratum lies well on one side of the
// horizon, where only the mean counts. Times the scaled width, the density's second antiderivative.
inline float meanCosine(float a, float variance) {
    float width = sqrt(5.0f * max(variance, 0.0f));
    if (a >= width) return a;
    if (a <= -width) return 0.0f;
    float e = a / width;
    return width * 0.0625f * (e + 1.0f) * (e + 1.0f) * (e + 1.0f) * (3.0f - e);
}

// A stratum that barely looks over the horizon has a mean near 0 and makes large weights. It is chosen as rarely, so
// that cutting them off there costs little energy (tests state how much).
const float romaMaxWeight = 8.0f;

// What tracing `direction`, chosen uniformly in a stratum, must count for so that the expectation over the choice is the
// cosine-weighted mean (see shaders/occupancy/roma.glsl). `flip` is -1 for the stratum opposite to `own`.
inline float romaWeight(RomaDirection own, float flip, vec3 direction, vec3 normal) {
    float variance = normal.x * normal.x * own.spreadXX + normal.y * normal.y * own.spreadYY +
                     normal.z * normal.z * own.spreadZZ +
                     2.0f * (normal.x * normal.y * own.spreadXY + normal.x * normal.z * own.spreadXZ +
                             normal.y * normal.z * own.spreadYZ);
    float mean = meanCosine(flip * dot(normal, own.mean), variance);
    float cosine = dot(normal, direction);
    if (cosine <= 0.0f) return 0.0f;
    return min(cosine, romaMaxWeight * mean) / max(mean, 1e-20f);
}

SHARED_END
