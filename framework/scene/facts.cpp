#include "scene/facts.h"
#include "scene/animation.h"
#include "scene/deform.h"
#include "scene/geometry.h"
#include "scene/texture_arrays.h"
#include "scene/timeline_bounds.h"
#include <cmath>

namespace kestrel {
namespace {

void countMaterial(const Material& material, std::uint32_t triangles, SceneFacts& facts) {
    const bool masked = material.alphaMode != AlphaMode::Opaque;
    if (masked) facts.maskedTriangles += triangles;
    facts.hasMasked |= masked;
    facts.hasBlend |= material.alphaMode == AlphaMode::Blend;
    facts.hasDoubleSided |= material.doubleSided;
    facts.hasSingleSided |= !material.doubleSided;
    facts.hasTextures |= material.baseColourTexture.present() ||
                         material.metallicRoughnessTexture.present() || material.normalTexture.present() ||
                         material.emissionTexture.present();
    facts.hasNormalMaps |= material.normalTexture.present();
    facts.hasEmission |= material.emission != glm::vec3(0);
    facts.hasTransmission |= material.transmission > 0;
    facts.hasUnlit |= material.unlit;
}

void countGeometry(const Scene& scene, SceneFacts& facts) {
    const std::vector<Instance> instances = instancesOf(scene);
    const std::vector<InstanceMotion> motion = instanceMotion(scene, instances);
    const Material standard;
    for (size_t i = 0; i < instances.size(); ++i) {
        const Primitive& primitive = *instances[i].primitive;
        const std::uint32_t triangles = static_cast<std::uint32_t>(primitive.indices.size() / 3);
        facts.triangles += triangles;
        facts.vertices += primitive.positions.size();
        if (triangles == 0) continue;
        facts.hasVertexColours |= !primitive.colours.empty();
        facts.geometryMoves |= motion[i].moves;
        facts.geometryDeforms |= motion[i].deforms;
        countMaterial(primitive.material < 0 ? standard
                                             : scene.materials[static_cast<size_t>(primitive.material)],
                      triangles, facts);
    }
    facts.instances = static_cast<std::uint32_t>(instances.size());
}

void countLights(const Scene& scene, const std::vector<bool>& moving, SceneFacts& facts) {
    for (const Light& light : scene.lights) {
        facts.lightsMove |= light.node >= 0 && moving[static_cast<size_t>(light.node)];
        switch (light.kind) {
        case LightKind::Point:
            ++facts.pointLights;
            break;
        case LightKind::Spot:
            ++facts.spotLights;
            if (light.outerCone > wideSpotCone) ++facts.wideSpotLights;
            break;
        case LightKind::Directional:
            ++facts.directionalLights;
            break;
        case LightKind::Rectangle:
            ++facts.rectangleLights;
            break;
        case LightKind::Sphere:
            ++facts.sphereLights;
            break;
        }
    }
}

// To float, away from the inside.
float roundedDown(double value) {
    const float rounded = static_cast<float>(value);
    return double(rounded) <= value ? rounded : std::nextafter(rounded, -INFINITY);
}
float roundedUp(double value) { return -roundedDown(-value); }

void measure(const Scene& scene, SceneFacts& facts) {
    const TimelineBounds bounds = timelineBounds(scene, scene.rootTransform);
    if (bounds.empty) return;
    const glm::dvec3 min = bounds.min - scene.origin, max = bounds.max - scene.origin;
    for (int axis = 0; axis < 3; ++axis) {
        // Flattening rounds the same differences to float: rounding outward contains those values too.
        facts.bounds.min[axis] = roundedDown(min[axis]);
        facts.bounds.max[axis] = roundedUp(max[axis]);
    }
    facts.sphere.centre = glm::vec3(bounds.centre() - scene.origin);
    // Rounding of the centre and of each vertex moves them by less than one part in 2^23 of what they are.
    constexpr double slack = 1.0 / (1 << 22);
    const double reach = glm::length(glm::max(glm::abs(min), glm::abs(max)));
    facts.sphere.radius = roundedUp(bounds.radius + slack * reach);
}

} // namespace

SceneFacts gatherFacts(const Scene& scene) {
    SceneFacts facts;
    const std::vector<bool> moving = movingNodes(scene);
    countGeometry(scene, facts);
    countLights(scene, moving, facts);
    for (const Camera& camera : scene.cameras) {
        facts.cameraMoves |=
            camera.path.size() > 1 || (camera.node >= 0 && moving[static_cast<size_t>(camera.node)]);
        facts.cameras.push_back(camera.name);
    }
    facts.materials = static_cast<std::uint32_t>(scene.materials.size());
    facts.images = static_cast<std::uint32_t>(scene.images.size());
    const TextureArrays colours = textureArrays(scene, TextureRole::Colour),
                        data = textureArrays(scene, TextureRole::Data);
    facts.colourTextureArrays = static_cast<std::uint32_t>(colours.arrays.size());
    facts.dataTextureArrays = static_cast<std::uint32_t>(data.arrays.size());
    facts.hasTiledTextures = colours.tiled() || data.tiled();
    facts.duration = scene.duration();
    measure(scene, facts);
    return facts;
}

} // namespace kestrel
