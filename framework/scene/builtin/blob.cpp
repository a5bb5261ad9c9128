// `blob`: a hare modelled as a displaced sphere. Coarse form by "grabs" (a region of directions is moved by a
// vector), fine form by noise along the coarse normals. The floor is hardly larger than the hare, since the
// extent of the scene sets the size of a voxel.
#include "scene/builtin/noise.h"
#include "scene/builtin/scene_builder.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"

namespace kestrel::builtin {
namespace {

// Moves the directions within `radius` (radians) of `towards` by `by`; full effect within `core` of that.
struct Grab {
    glm::vec3 towards;
    float radius, core;
    glm::vec3 by;
    bool mirrored; // also at -x
};

const Grab grabs[] = {
    {{0, 0.62f, 0.78f}, 0.66f, 0.45f, {0, 0.24f, 0.16f}, false},           // head
    {{0, 0.40f, 0.92f}, 0.30f, 0.20f, {0, -0.01f, 0.10f}, false},          // muzzle
    {{0.22f, 0.96f, 0.40f}, 0.19f, 0.05f, {0.10f, 0.36f, -0.17f}, true},   // ears
    {{0.23f, 0.94f, 0.48f}, 0.10f, 0.10f, {0.00f, -0.05f, -0.05f}, true},  // hollow of the ears
    {{0.38f, 0.62f, 0.86f}, 0.10f, 0.35f, {0.020f, 0.012f, 0.026f}, true}, // eyes
    {{0.22f, 0.36f, 0.95f}, 0.16f, 0.20f, {0.035f, -0.01f, 0.015f}, true}, // cheeks
    {{0.85f, -0.25f, -0.35f}, 0.65f, 0.35f, {0.13f, 0.02f, 0}, true},      // haunches
    {{0.72f, -0.66f, 0.20f}, 0.34f, 0.45f, {0.10f, -0.10f, 0.20f}, true},  // hind feet
    {{0.30f, -0.56f, 0.77f}, 0.30f, 0.45f, {0.03f, -0.14f, 0.10f}, true},  // fore feet
    {{0, -0.25f, -0.97f}, 0.38f, 0.30f, {0, 0.05f, -0.12f}, false},        // tail
};

float falloff(float angle, float radius, float core) {
    return 1 - glm::smoothstep(core * radius, radius, angle);
}

float angleBetween(const glm::vec3& a, const glm::vec3& b) {
    return 2 * std::asin(std::min(1.0f, 0.5f * glm::length(a - b)));
}

glm::vec3 mirroredX(const glm::vec3& v) { return {-v.x, v.y, v.z}; }

// Draws directions towards the ears, which are stretched the most and so need the most vertices.
glm::vec3 concentrate(const glm::vec3& direction) {
    glm::vec3 d = direction;
    for (const float side : {1.0f, -1.0f}) {
        const glm::vec3 ear = glm::normalize(glm::vec3(0.24f * side, 0.95f, 0.46f));
        const float a = angleBetween(d, ear);
        d = glm::normalize(glm::mix(d, ear, 0.55f * std::exp(-a * a / 0.09f)));
    }
    return d;
}

glm::vec3 coarseForm(const glm::vec3& sphere) {
    const glm::vec3 d = concentrate(sphere);
    glm::vec3 p = d * glm::vec3(0.36f, 0.38f, 0.47f) + glm::vec3(0, 0.33f, 0);
    for (const Grab& grab : grabs) {
        const glm::vec3 towards = glm::normalize(grab.towards);
        p += grab.by * falloff(angleBetween(d, towards), grab.radius, grab.core);
        if (grab.mirrored)
            p += mirroredX(grab.by) * falloff(angleBetween(d, mirroredX(towards)), grab.radius, grab.core);
    }
    // The belly sits on the floor: what would lie below it is pressed flat, smoothly.
    constexpr float soft = 0.04f;
    p.y = 0.5f * (p.y + std::sqrt(p.y * p.y + soft * soft)) - 0.3f * soft;
    return p;
}

// Height of the fur at a point of the coarse form: tufts with crevices between them, and finer strands.
float fur(const glm::vec3& p) {
    const glm::vec3 warped = p + 0.03f * glm::vec3(gradientNoise(p * 7.0f), gradientNoise(p * 7.0f + 31.0f),
                                                   gradientNoise(p * 7.0f + 57.0f));
    const Cellular tufts = cellularNoise(warped * glm::vec3(15, 11, 15));
    const float crevice = glm::smoothstep(0.0f, 0.35f, tufts.second - tufts.nearest);
    const float strands = fractalNoise(p * glm::vec3(38, 24, 38), 3);
    return 0.016f * (crevice - 1) + 0.008f * (0.6f - tufts.nearest) + 0.0035f * strands;
}

Primitive makeHare(int n) {
    Primitive hare;
    addCubeSphere(hare, n, coarseForm);
    for (size_t i = 0; i < hare.positions.size(); ++i) {
        const glm::vec3 p = hare.positions[i];
        // The face, the ears and the feet are smoother than the body.
        const float smoothTop = 1 - 0.6f * glm::smoothstep(0.66f, 0.84f, p.y);
        const float aboveFeet = glm::smoothstep(0.02f, 0.2f, p.y);
        hare.positions[i] += hare.normals[i] * fur(p) * smoothTop * aboveFeet;
    }
    smoothNormals(hare);
    return hare;
}

} // namespace

Scene makeBlob(Detail detail) {
    SceneBuilder b;
    const int coat = b.add(matte("coat", {0.52f, 0.38f, 0.27f}));
    const int stone = b.add(matte("stone", {0.62f, 0.62f, 0.60f}));
    b.addInstance("hare", b.addMesh("hare", makeHare(detail.steps(76, 6)), coat));

    Primitive floor;
    addLathe(floor, glm::mat4(1), {{0.88f, -0.06f}, {0.9f, -0.05f}, {0.9f, -0.012f}, {0.885f, 0}, {0, 0}},
             detail.steps(96, 12));
    b.addInstance("floor", b.addMesh("floor", std::move(floor), stone));

    b.addCamera("front", {1.25, 1.0, 1.8}, {0.0, 0.43, 0.05}, 37, 0.05f, 20);
    b.addCamera("side", {2.2, 0.8, 0.5}, {0, 0.46, 0.05}, 36, 0.05f, 20);
    b.addCamera("close", {0.8, 0.85, 1.1}, {0.05, 0.6, 0.3}, 36, 0.05f, 20);
    return std::move(b.scene);
}

} // namespace kestrel::builtin
