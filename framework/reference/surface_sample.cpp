#include "reference/surface_sample.h"
#include "reference/texture_sample.h"
#include "shared/bsdf.h"
#include "shared/ray.h"

namespace kestrel {
namespace {

// Edges of length about 1, or the squares of small scenes would vanish. Zero for a triangle without area.
glm::vec3 unitFaceNormal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 u = b - a, v = c - a;
    const glm::vec3 m = glm::max(glm::abs(u), glm::abs(v));
    const float size = std::max({m.x, m.y, m.z});
    if (!(size > 0)) return glm::vec3(0);
    const glm::vec3 face = glm::cross(u / size, v / size);
    return glm::dot(face, face) > 0 ? glm::normalize(face) : glm::vec3(0);
}

} // namespace

SurfaceSampler::SurfaceSampler(const Geometry& geometry, const Scene& scene)
    : geometry_(geometry)
    , scene_(scene)
    , materials_(flattenedMaterials(scene)) {
    for (size_t i = 0; i < linear_.size(); ++i) {
        const float c = static_cast<float>(i) / 255;
        linear_[i] = c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
    }
}

glm::vec4 SurfaceSampler::texture(const TextureRef& ref, std::uint32_t triangle, float u, float v,
                                  bool colour) const {
    if (!ref.present()) return glm::vec4(1);
    const std::uint32_t* corner = &geometry_.indices[3 * static_cast<size_t>(triangle)];
    const auto coord = [&](std::uint32_t vertex) {
        const VertexAttributes& at = geometry_.attributes[vertex];
        return ref.texCoord == 1 ? at.texCoord1 : at.texCoord;
    };
    const glm::vec2 texCoord = (1 - u - v) * coord(corner[0]) + u * coord(corner[1]) + v * coord(corner[2]);
    const TextureImage& image = scene_.images[static_cast<size_t>(ref.image)];
    return sampleTexels(ref, image.width, image.height, texCoord, [&](size_t i) {
        const std::uint8_t* texel = &image.rgba[4 * i];
        const auto value = [&](int k) {
            return colour ? linear_[texel[k]] : static_cast<float>(texel[k]) / 255;
        };
        return glm::vec4(value(0), value(1), value(2), static_cast<float>(texel[3]) / 255);
    });
}

glm::vec3 SurfaceSampler::emission(std::uint32_t triangle, float u, float v) const {
    const Material& material = materials_[geometry_.materials[triangle]];
    if (material.emission == glm::vec3(0)) return glm::vec3(0);
    return material.emission * glm::vec3(texture(material.emissionTexture, triangle, u, v, true));
}

glm::vec3 SurfaceSampler::bent(const Material& material, const TraceHit& hit, const glm::vec3& normal,
                               const glm::vec4& tangent) const {
    const TextureRef& map = material.normalTexture;
    // A tangent along the normal spans no frame; interpolation may also leave none.
    glm::vec3 t = glm::vec3(tangent) - normal * glm::dot(normal, glm::vec3(tangent));
    if (!map.present() || tangent.w == 0 || !(glm::dot(t, t) > 0)) return normal;
    t = glm::normalize(t);
    const glm::vec3 b = glm::cross(normal, t) * (tangent.w < 0 ? -1.0f : 1.0f);
    glm::vec3 bump = glm::vec3(texture(map, hit.triangle, hit.u, hit.v, false)) * 2.0f - 1.0f;
    bump *= glm::vec3(material.normalScale, material.normalScale, 1);
    const glm::vec3 sum = t * bump.x + b * bump.y + normal * bump.z;
    return glm::dot(sum, sum) > 0 ? glm::normalize(sum) : normal;
}

SurfaceSample SurfaceSampler::at(const TraceHit& hit, const glm::vec3& direction) const {
    const std::uint32_t* corner = &geometry_.indices[3 * static_cast<size_t>(hit.triangle)];
    const glm::vec3 a = geometry_.positions[corner[0]];
    const glm::vec3 b = geometry_.positions[corner[1]];
    const glm::vec3 c = geometry_.positions[corner[2]];
    const auto interpolated = [&](auto member) {
        return (1 - hit.u - hit.v) * (geometry_.attributes[corner[0]].*member) +
               hit.u * (geometry_.attributes[corner[1]].*member) +
               hit.v * (geometry_.attributes[corner[2]].*member);
    };
    SurfaceSample sample;
    sample.position = a + hit.u * (b - a) + hit.v * (c - a);
    const glm::vec3 face = unitFaceNormal(a, b, c);
    sample.faceNormal = face == glm::vec3(0) ? -glm::normalize(direction) : face;
    sample.reach = shared::faceReach(sample.faceNormal, sample.position, a, b, c);
    // Normals that cancel out leave the face's.
    const glm::vec3 normal = interpolated(&VertexAttributes::normal);
    sample.normal = glm::dot(normal, normal) > 0 ? glm::normalize(normal) : sample.faceNormal;
    const Material& material = materials_[geometry_.materials[hit.triangle]];
    glm::vec4 tangent = interpolated(&VertexAttributes::tangent);
    tangent.w = geometry_.attributes[corner[0]].tangent.w; // the same at all three, or meaningless in between
    sample.normal = bent(material, hit, sample.normal, tangent);
    const bool front = !(glm::dot(sample.faceNormal, direction) > 0);
    if (!front) {
        sample.faceNormal = -sample.faceNormal;
        sample.normal = -sample.normal;
    }
    const auto look = [&](const TextureRef& ref, bool colour) {
        return texture(ref, hit.triangle, hit.u, hit.v, colour);
    };
    const glm::vec4 base = material.baseColour * look(material.baseColourTexture, true) *
                           interpolated(&VertexAttributes::colour);
    sample.albedo = glm::vec3(base);
    sample.alpha = base.a;
    sample.emission = emission(hit.triangle, hit.u, hit.v);
    const glm::vec4 rough = look(material.metallicRoughnessTexture, false);
    sample.roughness = material.roughness * rough.g;
    sample.metallic = material.metallic * rough.b;
    sample.transmission = material.transmission;
    sample.eta = shared::relativeIndex(material.ior, front);
    sample.unlit = material.unlit;
    return sample;
}

} // namespace kestrel
