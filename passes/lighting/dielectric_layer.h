// The diffuse light that a dielectric surface lets through, where only its mean over all directions of light
// is known: what Composite mixes by.
#pragma once
#include <vector>

namespace kestrel {

// Entries along each axis of the table: cosine at the view (0 to 1), roughness (0 to 1).
inline constexpr int dielectricLayerSide = 32;

// The share of the diffuse light that leaves towards the view through the layer of refractive index 1.5.
// glTF 2.0 (appendix B) mixes diffuse and specular light by 1 - F(V.H): here its mean over the
// cosine-weighted hemisphere of light. At grazing views of smooth surfaces that mix gives out more than
// arrives; there what the specular lobe reflects of a uniform surrounding is taken away instead, so that no
// surface exceeds its surroundings.
float throughDielectricLayer(float cosView, float roughness);

// The function at equal steps, rows of equal roughness.
const std::vector<float>& dielectricLayerTable();

} // namespace kestrel
