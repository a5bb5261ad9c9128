// The specular lobe of a rough surface, as glTF 2.0 (appendix B) has it; the same formulas on both sides of the C++/GLSL
// border. Vectors are unit and in the surface's own frame: z along its normal.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

// Of a dielectric of refractive index 1.5, seen along the normal.
const float dielectricReflectance = 0.04f;

// The width of the distribution of microfacet normals. Below this least one it is narrower than float can tell from a
// mirror.
inline float ggxAlpha(float roughness) { return max(roughness * roughness, 1e-4f); }

// A microfacet normal of those that `view` sees, from two uniform numbers (Heitz, "Sampling the GGX Distribution of Visible
// Normals", 2018). A view from below the horizon is treated as one along it.
inline vec3 ggxVisibleNormal(vec3 view, float alpha, vec2 u) {
    // The ellipsoid becomes a unit hemisphere.
    vec3 stretched = normalize(vec3(alpha * view.x, alpha * view.y, max(view.z, 1e-6f)));
    float lengthSquared = stretched.x * stretched.x + stretched.y * stretched.y;
    float inverseLength = lengthSquared > 0.0f ? 1.0f / sqrt(lengthSquared) : 0.0f;
    vec3 t1 = lengthSquared > 0.0f ? vec3(-stretched.y * inverseLength, stretched.x * inverseLength, 0.0f)
                                   : vec3(1.0f, 0.0f, 0.0f);
    vec3 t2 = cross(stretched, t1);
    // Uniform on the disk that is the hemisphere's projection.
    float radius = sqrt(u.x);
    float phi = 6.28318530717959f * u.y;
    float p1 = radius * cos(phi);
    float p2 = radius * sin(phi);
    float s = 0.5f * (1.0f + stretched.z);
    p2 = (1.0f - s) * sqrt(max(0.0f, 1.0f - p1 * p1)) + s * p2;
    vec3 h = p1 * t1 + p2 * t2 + sqrt(max(0.0f, 1.0f - p1 * p1 - p2 * p2)) * stretched;
    return normalize(vec3(alpha * h.x, alpha * h.y, max(1e-6f, h.z)));
}

// sqrt(1 + alpha^2 tan^2) of Smith's function, from the cosine.
inline float smithRoot(float cosine, float alpha) {
    float c2 = max(cosine * cosine, 1e-12f);
    return sqrt(1.0f + alpha * alpha * max(0.0f, 1.0f - c2) / c2);
}

// G2 / G1: what is seen of the light that leaves, height-correlated (Heitz, "Understanding the Masking-Shadowing Function",
// 2014), over what was seen of the view; at most 1.
inline float ggxShadowing(float cosView, float cosLeaving, float alpha) {
    float view = smithRoot(cosView, alpha);
    return (1.0f + view) / (view + smithRoot(cosLeaving, alpha));
}

// Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", 1994.
inline vec3 schlickFresnel(vec3 f0, float cosine) {
    float m = clamp(1.0f - cosine, 0.0f, 1.0f);
    float m2 = m * m;
    return f0 + (vec3(1.0f) - f0) * (m2 * m2 * m);
}

// Specular BRDF of glTF 2.0 (appendix B) times the cosine at the light, for light from one direction: GGX microfacets (Walter et
// al., "Microfacet Models for Refraction through Rough Surfaces", 2007), height-correlated Smith shadowing, Schlick's Fresnel
// term. All directions unit, away from the surface; 0 below the horizon.
inline vec3 specularLobe(vec3 n, vec3 toEye, vec3 toLight, vec3 f0, float alpha) {
    float cosEye = dot(n, toEye);
    float cosLight = dot(n, toLight);
    vec3 sum = toEye + toLight;
    vec3 h = sum * inversesqrt(max(dot(sum, sum), 1e-12f));
    float cosHalf = clamp(dot(n, h), 0.0f, 1.0f);
    float a2 = alpha * alpha;
    float base = 1.0f + (a2 - 1.0f) * cosHalf * cosHalf;
    float density = a2 / max(3.14159265358979f * base * base, 1e-30f);
    // G2 / (4 cosEye cosLight) times cosLight.
    float geometry = 2.0f / (smithRoot(cosEye, alpha) + smithRoot(cosLight, alpha)) / (4.0f * max(cosEye, 1e-4f));
    vec3 fresnel = schlickFresnel(f0, dot(h, toLight));
    return cosEye > 0.0f && cosLight > 0.0f ? fresnel * (density * geometry) : vec3(0.0f);
}

SHARED_END
