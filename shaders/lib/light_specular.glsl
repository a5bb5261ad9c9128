// The specular lobe of glTF 2.0 (appendix B) for light from one direction.
#include "lib/sampling.glsl"
#include "shared/ggx.h"

// Specular BRDF times the cosine at the light: GGX microfacets (Walter et al., "Microfacet Models for Refraction through
// Rough Surfaces", 2007), height-correlated Smith shadowing, Schlick's Fresnel term. All directions unit, away from the
// surface; 0 below the horizon.
vec3 specularLobe(vec3 n, vec3 toEye, vec3 toLight, vec3 f0, float alpha) {
    float cosEye = dot(n, toEye);
    float cosLight = dot(n, toLight);
    vec3 sum = toEye + toLight;
    vec3 h = sum * inversesqrt(max(dot(sum, sum), 1e-12));
    float cosHalf = clamp(dot(n, h), 0.0, 1.0);
    float a2 = alpha * alpha;
    float base = 1.0 + (a2 - 1.0) * cosHalf * cosHalf;
    float density = a2 / max(pi * base * base, 1e-30);
    // G2 / (4 cosEye cosLight) times cosLight.
    float geometry = 2.0 / (smithRoot(cosEye, alpha) + smithRoot(cosLight, alpha)) / (4.0 * max(cosEye, 1e-4));
    vec3 fresnel = schlickFresnel(f0, dot(h, toLight));
    return cosEye > 0.0 && cosLight > 0.0 ? fresnel * (density * geometry) : vec3(0.0);
}
