#include "reference/primary_hits.h"
#include <limits>

namespace kestrel {
namespace {

void set(Image& image, int x, int y, const glm::vec3& value) {
    for (int k = 0; k < 3; ++k) image.at(x, y, k) = value[k];
}

void fillPixel(PrimaryHits& out, const Geometry& geometry, const glm::mat4& viewProjection, int x, int y,
               const TraceRay& ray, const TraceHit& hit) {
    const std::uint32_t* corner = &geometry.indices[3 * static_cast<size_t>(hit.triangle)];
    const glm::vec3 a = geometry.positions[corner[0]];
    const glm::vec3 b = geometry.positions[corner[1]];
    const glm::vec3 c = geometry.positions[corner[2]];
    const float w = 1 - hit.u - hit.v;
    const glm::vec3 position = w * a + hit.u * b + hit.v * c;
    glm::vec3 face = glm::normalize(glm::cross(b - a, c - a));
    if (glm::dot(face, ray.direction) > 0) face = -face;
    glm::vec3 normal = w * geometry.attributes[corner[0]].normal +
                       hit.u * geometry.attributes[corner[1]].normal +
                       hit.v * geometry.attributes[corner[2]].normal;
    // Normals that cancel out, as on a triangle folded over an edge, leave the face's.
    normal = glm::dot(normal, normal) > 0 ? glm::normalize(normal) : face;
    if (glm::dot(normal, face) < 0) normal = -normal;
    const glm::vec4 clip = viewProjection * glm::vec4(position, 1);
    out.depth.at(x, y) = clip.z / clip.w;
    out.viewDepth.at(x, y) = hit.t;
    set(out.position, x, y, position);
    set(out.normal, x, y, normal);
    set(out.faceNormal, x, y, face);
}

} // namespace

std::vector<TraceRay> cameraRays(const CameraState& camera, int width, int height, int y) {
    const glm::mat4 projection = camera.projection(static_cast<float>(width) / static_cast<float>(height));
    const glm::mat4 toRender = glm::inverse(camera.view);
    const auto centre = [](int i, int n) {
        return 2 * (static_cast<float>(i) + 0.5f) / static_cast<float>(n) - 1;
    };
    std::vector<TraceRay> rays(static_cast<size_t>(width));
    for (int x = 0; x < width; ++x) {
        // A point at distance 1 from the eye plane; z is -1, so that t counts along the axis.
        const glm::vec2 p(centre(x, width) / projection[0][0], -centre(y, height) / projection[1][1]);
        const glm::vec3 from = camera.orthographic ? glm::vec3(p, 0) : glm::vec3(0);
        const glm::vec3 along = camera.orthographic ? glm::vec3(0, 0, -1) : glm::vec3(p, -1);
        TraceRay& ray = rays[static_cast<size_t>(x)];
        ray.origin = glm::vec3(toRender * glm::vec4(from, 1));
        ray.direction = glm::mat3(toRender) * along;
        ray.tMin = camera.nearPlane;
        ray.tMax = camera.farPlane > 0 ? camera.farPlane : std::numeric_limits<float>::infinity();
    }
    return rays;
}

PrimaryHits primaryHits(const ReferenceTracer& tracer, const Geometry& geometry, const CameraState& camera,
                        int width, int height, int threads) {
    PrimaryHits out{Image(width, height, 1), Image(width, height, 1), Image(width, height, 3),
                    Image(width, height, 3), Image(width, height, 3), {}};
    out.triangles.assign(out.depth.pixelCount(), TraceHit::none);
    const glm::mat4 viewProjection =
        camera.projection(static_cast<float>(width) / static_cast<float>(height)) * camera.view;
    forEachRow(height, threads, [&](int y) {
        const std::vector<TraceRay> rays = cameraRays(camera, width, height, y);
        std::vector<TraceHit> hits(rays.size());
        tracer.closestHits(rays, hits, true);
        for (int x = 0; x < width; ++x) {
            const TraceHit& hit = hits[static_cast<size_t>(x)];
            out.triangles[out.depth.index(x, y)] = hit.triangle;
            if (hit.triangle != TraceHit::none)
                fillPixel(out, geometry, viewProjection, x, y, rays[static_cast<size_t>(x)], hit);
        }
    });
    return out;
}

} // namespace kestrel
