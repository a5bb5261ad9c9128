// Rays of a pixel's hemisphere or of a test's own through an A-buffer and, beside it, through the hierarchy.
#pragma once
#include "traced_fixture.h"
#include <fmt/format.h>

namespace kestrel::test {

struct ABufferRays : TracedTest {
    static constexpr Extent size{64, 36, 1};

    static Graph graph(const std::string& rays, const std::vector<std::string>& settings) {
        Graph made = parseGraph(R"({"kestrel": 1, "passes": {
            "gbuffer": {"type": "GBuffer"},
            "bounds": {"type": "ABufferBounds", "properties": {"side": 64}},
            "store": {"type": "ABufferStore"}, "reorder": {"type": "ABufferReorder"},
            "abuffer": {"type": "ABuffer", "properties": {"count_exhausted": true}}, "bvh": {"type": "Bvh"},
            "hemisphere": {"type": "HemisphereRays"}, "own": {"type": "RaySource"},
            "query": {"type": "RayQuery", "properties": {"query": "closest"}},
            "exact": {"type": "RayQuery", "properties": {"query": "closest"}}},
            "edges": [["bounds.bounds", "store.bounds"], ["bounds.cube_bounds", "store.cube_bounds"],
                ["store.pixels", "reorder.stored_pixels"], ["store.nodes", "reorder.stored_nodes"],
                ["store.data", "reorder.data"], ["store.segments", "reorder.segments"],
                ["reorder.pixels", "abuffer.pixels"], ["reorder.nodes", "abuffer.nodes"], ["reorder.triangles", "abuffer.data"],
                ["gbuffer.depth", "hemisphere.depth"], ["gbuffer.normal", "hemisphere.normal"],
                ["gbuffer.face_normal", "hemisphere.face_normal"],
                ["abuffer.tracer", "query.tracer"], ["bvh.tracer", "exact.tracer"]],
            "outputs": []})",
                                "test.json");
        std::vector<std::string> all = settings;
        for (const char* query : {"query", "exact"}) all.push_back(fmt::format("{}.rays={}", query, rays));
        for (const std::string& setting : all) applySetting(made, tracedRegistry(), setting);
        for (const char* query : {"query", "exact"}) made.outputs.push_back({{query, "hits"}, {}});
        return made;
    }
    struct Hits {
        std::vector<shared::HitRecord> abuffer, bvh;
        double exhausted = 0;
    };
    static Hits hits(const Scene& scene, const std::string& rays,
                     const std::vector<std::string>& settings = {}) {
        RenderOptions options;
        options.size = size;
        options.countIterations = true;
        Renderer made(graph(rays, settings), tracedRegistry(), scene, context().capabilities(), options);
        made.frame();
        made.frame(); // tells what was exhausted in the first
        const auto& values = made.last().values;
        const auto told = values.find("abuffer");
        return {as<shared::HitRecord>(made.readBytes({"query", "hits"})),
                as<shared::HitRecord>(made.readBytes({"exact", "hits"})),
                told == values.end() ? -1 : told->second.at("exhausted rays")};
    }
};

// A scene of triangles with the eye in this place, looking along -z.
inline Scene seenFrom(const glm::vec3& eye, std::vector<glm::vec3> corners) {
    Scene scene = trianglesScene(std::move(corners));
    Camera camera;
    camera.name = "inside";
    Node node;
    node.camera = 0;
    node.translation = eye;
    camera.node = static_cast<int>(scene.nodes.size());
    scene.cameras = {camera};
    scene.nodes.push_back(node);
    scene.roots.push_back(static_cast<int>(scene.nodes.size()) - 1);
    finishScene(scene);
    return scene;
}

// The square of half width 1 on an axis, at this place along it.
inline void addWall(std::vector<glm::vec3>& corners, int axis, float at) {
    for (const glm::vec3& p : square()) {
        glm::vec3 corner;
        corner[axis] = at;
        corner[(axis + 1) % 3] = p.x;
        corner[(axis + 2) % 3] = p.y;
        corners.push_back(corner);
    }
}

// Six walls about the eye.
inline std::vector<glm::vec3> roomWalls() {
    std::vector<glm::vec3> corners;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0f, 1.0f}) addWall(corners, axis, side);
    return corners;
}

// With the eye off the middle.
inline Scene room() { return seenFrom({0.13f, -0.21f, 0.3f}, roomWalls()); }

// Distance along a ray from within to the walls.
inline float toWall(const glm::vec3& origin, const glm::vec3& direction) {
    float t = INFINITY;
    for (int axis = 0; axis < 3; ++axis)
        if (direction[axis] != 0)
            t = std::min(t, ((direction[axis] > 0 ? 1.0f : -1.0f) - origin[axis]) / direction[axis]);
    return t;
}

} // namespace kestrel::test
