// Effects by rays in one graph: every tracer and light that the tests move the edges of.
#pragma once
#include "shipped_fixture.h"
#include <functional>
#include <glm/gtc/matrix_transform.hpp>

namespace kestrel::test {

inline const PortRef bounce{"bounce", "result"}, shadowed{"lit", "result"}, shine{"shine", "result"},
    openness{"open", "result"}, skyVisible{"seen", "result"};

// By BVH, with light from `direct` unless `settings` say otherwise.
inline Graph effectsGraph(const std::vector<PortRef>& outputs,
                          const std::vector<std::string>& settings = {}) {
    Graph graph = parseGraph(R"({
        "kestrel": 1,
        "passes": {
            "gbuffer": { "type": "GBuffer" },
            "bom": { "type": "OccupancyMap", "properties": { "resolution": 64, "method": "exact" } },
            "roma": { "type": "Roma", "properties": { "offset": 1.5 } },
            "bvh": { "type": "Bvh" },
            "sky": { "type": "Environment", "properties": { "kind": "constant" } },
            "direct": { "type": "DirectLight" },
            "rsm": { "type": "ReflectiveShadowMap", "properties": { "resolution": 256 } },
            "indirect": { "type": "IndirectDiffuse", "properties": { "rays": 16 } },
            "shadow": { "type": "SoftShadow", "properties": { "rays": 16 } },
            "glossy": { "type": "GlossyReflection", "properties": { "rays": 16 } },
            "ao": { "type": "RayAmbientOcclusion", "properties": { "rays": 16, "snap": false } },
            "gather": { "type": "RsmGather" },
            "seen": { "type": "Accumulate" },
            "bounce": { "type": "Accumulate" },
            "lit": { "type": "Accumulate" },
            "open": { "type": "Accumulate" },
            "shine": { "type": "Accumulate" }
        },
        "edges": [
            ["bom.occupancy", "roma.occupancy"], ["bom.grid", "roma.grid"],
            ["gbuffer.depth", "direct.depth"], ["gbuffer.normal", "direct.normal"],
            ["gbuffer.depth", "indirect.depth"], ["gbuffer.normal", "indirect.normal"], ["gbuffer.face_normal", "indirect.face_normal"],
            ["bvh.tracer", "indirect.tracer"], ["direct.radiance", "indirect.radiance"],
            ["indirect.result", "bounce.signal"], ["indirect.weight", "bounce.weight"],
            ["gbuffer.depth", "shadow.depth"], ["gbuffer.normal", "shadow.normal"], ["gbuffer.face_normal", "shadow.face_normal"],
            ["bvh.tracer", "shadow.tracer"],
            ["shadow.result", "lit.signal"], ["shadow.visibility", "open.signal"],
            ["shadow.weight", "open.weight"],
            ["gbuffer.depth", "glossy.depth"], ["gbuffer.normal", "glossy.normal"], ["gbuffer.face_normal", "glossy.face_normal"],
            ["gbuffer.albedo", "glossy.albedo"], ["gbuffer.material", "glossy.material"],
            ["bvh.tracer", "glossy.tracer"], ["direct.radiance", "glossy.radiance"],
            ["glossy.result", "shine.signal"],
            ["gbuffer.depth", "ao.depth"], ["gbuffer.normal", "ao.normal"], ["gbuffer.face_normal", "ao.face_normal"], ["bvh.tracer", "ao.tracer"],
            ["ao.visibility", "seen.signal"],
            ["gbuffer.depth", "gather.depth"], ["gbuffer.normal", "gather.normal"], ["gbuffer.face_normal", "gather.face_normal"], ["rsm.maps", "gather.maps"],
            ["rsm.map_radiance", "gather.map_radiance"], ["rsm.map_normal", "gather.map_normal"],
            ["rsm.map_position", "gather.map_position"]
        ],
        "outputs": []
    })",
                             "effects.json");
    for (const std::string& setting : settings) applySetting(graph, shipped(), setting);
    for (const PortRef& output : outputs) graph.outputs.push_back({output, {}});
    return graph;
}

// The same by Embree: passes indirect, shadow and glossy.
inline Graph embreeGraph(const std::vector<PortRef>& outputs, const std::vector<std::string>& settings = {}) {
    Graph graph = shippedGraph("reference_light", settings);
    graph.outputs.clear();
    for (const PortRef& output : outputs) graph.outputs.push_back({output, {}});
    return graph;
}

inline bool hasReferences() { return shipped().find("ReferenceIndirectDiffuse") != nullptr; }

inline CameraState lookingAt(const glm::vec3& eye, const glm::vec3& target, const glm::vec3& up = {0, 1, 0}) {
    CameraState camera;
    camera.view = glm::lookAt(eye, target, up);
    camera.position = eye;
    camera.nearPlane = 0.01f * glm::length(target - eye);
    camera.farPlane = 0;
    return camera;
}

inline void addLightTo(Scene& scene, const Light& light, const glm::dvec3& position, const glm::dquat& turn) {
    Node node;
    node.translation = position;
    node.rotation = turn;
    node.light = static_cast<int>(scene.lights.size());
    scene.lights.push_back(light);
    scene.lights.back().node = static_cast<int>(scene.nodes.size());
    scene.roots.push_back(static_cast<int>(scene.nodes.size()));
    scene.nodes.push_back(node);
}

// Shines down (-y) for the identity.
inline const glm::dquat downwards = glm::angleAxis(-glm::half_pi<double>(), glm::dvec3(1, 0, 0));

inline std::vector<glm::vec3> parallelogram(const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v) {
    return {corner, corner + u, corner + u + v, corner, corner + u + v, corner + v};
}

inline std::vector<glm::vec3> joined(std::vector<glm::vec3> a, const std::vector<glm::vec3>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

// A ball of triangles.
inline std::vector<glm::vec3> ball(float radius, int n) {
    const auto at = [&](int i, int j) {
        const float a = glm::pi<float>() * static_cast<float>(i) / static_cast<float>(n),
                    b = glm::pi<float>() * static_cast<float>(j % (2 * n)) / static_cast<float>(n);
        return radius * glm::vec3(i == n ? 0 : std::sin(a) * std::cos(b), std::cos(a),
                                  i == n ? 0 : std::sin(a) * std::sin(b));
    };
    std::vector<glm::vec3> corners;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < 2 * n; ++j) {
            const glm::vec3 a = at(i, j), b = at(i, j + 1), c = at(i + 1, j + 1), d = at(i + 1, j);
            if (i > 0) corners.insert(corners.end(), {a, c, b});
            if (i + 1 < n) corners.insert(corners.end(), {a, d, c});
        }
    return corners;
}

struct EffectsTest : ShippedTest {
    static constexpr Extent small{48, 27, 1};
    static std::vector<Image> run(const Graph& graph, const Scene& scene, const std::vector<PortRef>& ports,
                                  int frames, const std::optional<CameraState>& camera = {},
                                  Extent size = small) {
        RenderOptions options;
        options.checkFinite = true;
        Renderer made = renderer(graph, scene, options, size);
        if (camera) made.setFreeCamera(*camera);
        for (int i = 0; i < frames; ++i) made.frame();
        std::vector<Image> images;
        for (const PortRef& port : ports) images.push_back(made.read(port));
        return images;
    }
};

// Of the colours of two images, where `mask` (one channel or more) is above 0.
inline double colourError(const Image& a, const Image& b, const Image& mask) {
    double sum = 0, count = 0;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            if (!(mask.at(x, y, 0) > 0)) continue;
            for (int k = 0; k < 3; ++k) sum += std::pow(double{a.at(x, y, k)} - double{b.at(x, y, k)}, 2);
            count += 3;
        }
    return count > 0 ? std::sqrt(sum / count) : 0;
}

} // namespace kestrel::test
