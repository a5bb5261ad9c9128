// What the tests of tracers share: rays of a test's own, and graphs in which any tracer answers them or makes
// ambient occlusion.
#pragma once
#include "execute/commands.h"
#include "image/error_figures.h"
#include "ray_source.h"
#include "shipped_fixture.h"
#include <limits>
#include <random>

namespace kestrel::test {

inline const Registry& tracedRegistry() {
    static const Registry instance = [] {
        Registry registry = shipped();
        registry.add(RaySource::type());
        return registry;
    }();
    return instance;
}

// Every tracer of this plugin's tests, on one map and one depth. "rays" are one a pixel over the hemisphere,
// "own" the test's.
inline Graph tracedGraph(const std::vector<std::string>& settings, const std::vector<PortRef>& outputs) {
    Graph graph = parseGraph(R"({"kestrel": 1, "passes": {
        "gbuffer": {"type": "GBuffer"},
        "bom": {"type": "OccupancyMap", "properties": {"resolution": 128, "method": "exact"}},
        "field": {"type": "DistanceField"},
        "flooded": {"type": "DistanceField", "properties": {"method": "jump_flooding"}},
        "roma": {"type": "Roma"},
        "bvh": {"type": "Bvh"},
        "screen": {"type": "ScreenTrace"},
        "hybrid": {"type": "NearFarTracer"},
        "nested": {"type": "NearFarTracer", "properties": {"reach": 0.5}},
        "rays": {"type": "HemisphereRays"},
        "own": {"type": "RaySource"},
        "query": {"type": "RayQuery", "properties": {"query": "closest"}},
        "other": {"type": "RayQuery", "properties": {"query": "closest"}},
        "ao": {"type": "RayAmbientOcclusion", "properties": {"rays": 4, "snap": true}},
        "mean": {"type": "Accumulate"}},
        "edges": [["bom.occupancy", "field.occupancy"], ["bom.grid", "field.grid"],
            ["bom.occupancy", "flooded.occupancy"], ["bom.grid", "flooded.grid"],
            ["bom.occupancy", "roma.occupancy"], ["bom.grid", "roma.grid"],
            ["gbuffer.depth", "screen.depth"],
            ["screen.tracer", "hybrid.near"], ["roma.tracer", "hybrid.far"],
            ["hybrid.tracer", "nested.near"], ["bvh.tracer", "nested.far"],
            ["gbuffer.depth", "rays.depth"], ["gbuffer.normal", "rays.normal"],
            ["rays.rays", "query.rays"], ["bvh.tracer", "query.tracer"],
            ["rays.rays", "other.rays"], ["bvh.tracer", "other.tracer"],
            ["gbuffer.depth", "ao.depth"], ["gbuffer.normal", "ao.normal"], ["bvh.tracer", "ao.tracer"],
            ["ao.visibility", "mean.signal"], ["ao.weight", "mean.weight"]],
        "outputs": ["mean.result"]})",
                             "test.json");
    for (const std::string& setting : settings) applySetting(graph, tracedRegistry(), setting);
    graph.outputs.clear();
    for (const PortRef& port : outputs) graph.outputs.push_back({port, {}});
    return graph;
}

inline shared::RayRecord rayRecord(const glm::vec3& origin, const glm::vec3& direction,
                                   const glm::vec3& normal = glm::vec3(0), float tMin = 0,
                                   float tMax = std::numeric_limits<float>::infinity()) {
    shared::RayRecord record{};
    record.origin = origin;
    record.direction = glm::normalize(direction);
    record.tMin = tMin;
    record.tMax = tMax;
    record.normal = normal;
    record.flags = 1;
    return record;
}

// `count` directions over the hemisphere around z, cosine-weighted (Malley), the same each time.
inline std::vector<glm::vec3> hemisphereDirections(int count, std::uint32_t seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<glm::vec3> directions;
    for (int i = 0; i < count; ++i) {
        const float radius = std::sqrt(unit(random)), angle = 6.2831853f * unit(random);
        const float x = radius * std::cos(angle), y = radius * std::sin(angle);
        directions.emplace_back(x, y, std::sqrt(std::max(0.0f, 1 - x * x - y * y)));
    }
    return directions;
}

struct TracedTest : ShippedTest {
    static Renderer traced(Scene scene, const std::vector<std::string>& settings,
                           const std::vector<PortRef>& outputs, RenderOptions options = {},
                           Extent size = {96, 54, 1}) {
        options.size = size;
        return {tracedGraph(settings, outputs), tracedRegistry(), std::move(scene), context().capabilities(),
                std::move(options)};
    }
    // What a tracer ("field.tracer") says of these rays.
    static std::vector<shared::HitRecord> ask(const Scene& scene, const std::string& tracer,
                                              std::vector<shared::RayRecord> rays,
                                              std::vector<std::string> settings = {}) {
        RaySource::rays = std::move(rays);
        settings.push_back("query.rays=own.rays");
        settings.push_back("query.tracer=" + tracer);
        Renderer made = traced(scene, settings, {{"query", "hits"}});
        made.frame();
        return as<shared::HitRecord>(made.readBytes({"query", "hits"}));
    }
    // Visibility by a tracer, in the mean of these frames of four rays.
    static Image occlusion(const Scene& scene, const std::string& tracer, int frames,
                           std::vector<std::string> settings = {}, Extent size = {96, 54, 1}) {
        settings.push_back("ao.tracer=" + tracer);
        Renderer made = traced(scene, settings, {{"mean", "result"}}, {}, size);
        for (int i = 0; i < frames; ++i) made.frame();
        return made.read({"mean", "result"});
    }
    // Nothing that a tracer makes of a scene is out of range or not finite, also in bounded rays, snapped or
    // not.
    static void expectSound(const Scene& scene, const std::string& tracer,
                            const std::vector<std::string>& settings = {}, Extent size = {48, 27, 1}) {
        RenderOptions options;
        options.checkFinite = true;
        for (const char* distance : {"ao.distance=0", "ao.distance=0.01"}) {
            std::vector<std::string> all = settings;
            all.insert(all.end(), {"ao.tracer=" + tracer, distance, "other.tracer=" + tracer});
            Renderer made = traced(scene, all, {{"mean", "result"}, {"other", "hits"}}, options, size);
            for (int i = 0; i < 2; ++i) made.frame();
            for (const float value : made.read({"mean", "result"}).values)
                ASSERT_TRUE(value >= 0 && value <= 1) << tracer << " = " << value;
            for (const auto& hit : as<shared::HitRecord>(made.readBytes({"other", "hits"})))
                ASSERT_TRUE(hit.t >= 0) << tracer << " hits at " << hit.t; // infinite: none; never NaN
        }
    }
};

} // namespace kestrel::test
