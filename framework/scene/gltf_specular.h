// KHR_materials_pbrSpecularGlossiness as metallic-roughness.
#pragma once
#include "scene/material.h"

namespace kestrel {

struct GltfContext;

// The extension's values; colours linear.
struct SpecularMaterial {
    glm::vec4 diffuse{1};
    glm::vec3 specular{1};
    float glossiness = 1;
    TextureRef diffuseTexture, specularTexture;
};

struct MetallicSurface {
    glm::vec3 baseColour{1};
    float metallic = 0;
};

// The base colour and metalness that give a surface of this diffuse factor and reflectance at normal
// incidence back: exactly where both are grey, else the least sum of squares over the channels with the
// metalness of their means. A dielectric reflects 0.04, as glTF has it.
MetallicSurface metallicSurface(const glm::vec3& diffuse, const glm::vec3& specular);

// Sets base colour, metalness, roughness and their textures. Textures are combined pixel by pixel into new
// images of the scene. Says in a warning that the material was converted.
void convertSpecular(GltfContext& context, const SpecularMaterial& source, Material& material);

} // namespace kestrel
