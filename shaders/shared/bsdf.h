// What surfaces make of light, as directions that paths are drawn along; the same formulas on both sides of the C++/GLSL
// border.
//
// A surface is metal, glass, or an opaque dielectric, each by its share (glTF 2.0, appendix B; KHR_materials_transmission):
//
//   metal    GGX microfacets, Schlick's term of the base colour
//   layer    GGX microfacets of a smooth interface over a diffuse base: what the facet does not reflect the base does. The
//            interface reflects as Fresnel's formulas say (glTF allows Schlick's approximation of them), so that one of index
//            1 is none
//   glass    a smooth interface, whatever the roughness; what passes is refracted and takes the base colour, on every passage.
//            No volume is known (KHR_materials_volume is not read), so a pane must have its thickness as geometry
//
// One scattering off microfacets is what GGX gives: what would bounce twice between them is lost, so no surface sends out
// more than arrives. Radiance is not scaled by the squared index as light enters glass: the factor is undone where it leaves,
// and without it no throughput exceeds 1. Directions are unit, in the surface's own frame: z along the shading normal on the
// side of `view`.
#pragma once
#include "shared/ggx.h"

SHARED_BEGIN

struct BsdfSurface {
    vec3 colour; // linear base colour
    float metallic;
    float roughness;
    float transmission;
    float eta; // index of refraction behind the surface over that before it: relativeIndex()
};

const uint bsdfNone = 0u; // the path ends
const uint bsdfDiffuse = 1u;
const uint bsdfReflection = 2u;
const uint bsdfTransmission = 3u;

struct BsdfSample {
    vec3 direction; // to go on along
    vec3 weight;    // BSDF times cosine over the density of the choice: at most 1 for a colour of at most 1
    vec3 diffuse;   // albedo that lights shine on; its mean over the choices is that of the diffuse part
    uint lobe;
};

// Of a material of this index, seen from its front or back. KHR_materials_ior: 0 stands for an interface that reflects
// everything.
inline float relativeIndex(float ior, bool front) {
    float index = ior >= 1.0f ? ior : 1e4f;
    return front ? index : 1.0f / index;
}

// Share of unpolarised light that a smooth interface reflects (Fresnel), from the cosine before it.
inline float dielectricFresnel(float cosine, float eta) {
    float c = clamp(cosine, 0.0f, 1.0f);
    float squared = eta * eta - 1.0f + c * c; // of eta times the cosine behind it
    float g = sqrt(max(squared, 0.0f));
    float across = (c - g) / max(c + g, 1e-12f);
    float along = (eta * eta * c - g) / max(eta * eta * c + g, 1e-12f);
    return squared < 0.0f ? 1.0f : min(0.5f * (across * across + along * along), 1.0f);
}

// Where light goes that passes a smooth interface across z; only where dielectricFresnel() is below 1.
inline vec3 refracted(vec3 view, float eta) {
    float behind = sqrt(max(0.0f, 1.0f - (1.0f - view.z * view.z) / (eta * eta)));
    return normalize(vec3(-view.x / eta, -view.y / eta, -behind));
}

// Draws a direction: `choice` and `facet` uniform in [0, 1), `cosineWeighted` a direction about z of density cosine / pi, all
// independent of each other.
inline BsdfSample sampleBsdf(BsdfSurface at, vec3 view, float choice, vec2 facet, vec3 cosineWeighted) {
    BsdfSample result;
    result.diffuse = vec3(0.0f);
    vec3 v = vec3(view.x, view.y, max(view.z, 1e-4f));
    float metal = clamp(at.metallic, 0.0f, 1.0f);
    float glass = (1.0f - metal) * clamp(at.transmission, 0.0f, 1.0f);
    if (choice >= metal && choice < metal + glass) {
        float part = (choice - metal) / glass;
        bool reflects = part < dielectricFresnel(v.z, at.eta);
        result.direction = reflects ? vec3(-v.x, -v.y, v.z) : refracted(v, at.eta);
        result.weight = reflects ? vec3(1.0f) : at.colour;
        result.lobe = reflects ? bsdfReflection : bsdfTransmission;
        return result;
    }
    float alpha = ggxAlpha(at.roughness);
    vec3 h = ggxVisibleNormal(v, alpha, facet);
    float cosine = dot(v, h);
    vec3 leaving = 2.0f * cosine * h - v;
    float unshadowed = ggxShadowing(v.z, leaving.z, alpha);
    result.direction = normalize(leaving);
    result.lobe = leaving.z > 0.0f ? bsdfReflection : bsdfNone;
    if (choice < metal) {
        result.weight = schlickFresnel(at.colour, cosine) * unshadowed;
        return result;
    }
    // An opaque base lies behind its interface, from whichever side it is seen.
    float share = dielectricFresnel(cosine, max(at.eta, 1.0f / at.eta));
    result.diffuse = at.colour * (1.0f - share);
    result.weight = vec3(unshadowed);
    if (choice - metal - glass >= share * (1.0f - metal - glass)) {
        result.direction = cosineWeighted;
        result.weight = at.colour;
        result.lobe = bsdfDiffuse;
    }
    return result;
}

SHARED_END
