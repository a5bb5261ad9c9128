// What the tests of passes/occupancy share: scenes of a few triangles, a graph of the two passes, and rays
// through them.
#pragma once
#include "core/files.h"
#include "execute/commands.h"
#include "execute/renderer.h"
#include "gl/gl_fixture.h"
#include "gl/ray_source.h"
#include "passes/occupancy/grid.h"
#include "passes/occupancy/occupancy_map.h"
#include "passes/occupancy/occupancy_trace.h"
#include "passes/occupancy/roma.h"
#include "passes/occupancy/roma_cascade.h"
#include "plugin/loader.h"
#include "shared/ray.h"
#include "support/folders.h"
#include <bit>
#include <limits>
#include <random>

namespace kestrel::test {

// Triangles, three corners each, as a scene with the default material.
inline Scene sceneOf(std::vector<glm::vec3> corners) {
    Scene scene;
    scene.name = "triangles";
    Primitive primitive;
    for (std::uint32_t i = 0; i < corners.size(); ++i) primitive.indices.push_back(i);
    primitive.positions = std::move(corners);
    scene.meshes.push_back({"mesh", {primitive}, {}});
    Node node;
    node.mesh = 0;
    scene.nodes.push_back(node);
    scene.roots = {0};
    finishScene(scene);
    return scene;
}

inline Scene emptyScene() {
    Scene scene;
    finishScene(scene);
    return scene;
}

// Triangles of all sizes and directions within the unit ball.
inline std::vector<glm::vec3> randomTriangles(int count, std::uint32_t seed, float scale = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto inBall = [&] {
        for (;;) {
            const glm::vec3 p(unit(random), unit(random), unit(random));
            if (glm::dot(p, p) < 1) return p;
        }
    };
    std::vector<glm::vec3> corners;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 centre = inBall();
        const float size = std::pow(10.0f, -3 * std::abs(unit(random)));
        for (int k = 0; k < 3; ++k) {
            glm::vec3 p = centre + size * inBall();
            if (glm::length(p) > 1) p = glm::normalize(p);
            corners.push_back(p * scale);
        }
    }
    return corners;
}

// Hands out an occupancy map that no scene has made.
class MapSource final : public Pass {
public:
    static PassType type() {
        return Describe<MapSource>("MapSource", "An occupancy map of a test")
            .output("occupancy", PortKind::Buffer, "The bits")
            .carries(content::elements("OccupancyWord"))
            .output("grid", PortKind::Buffer, "Where the cells lie")
            .carries(content::elements("OccupancyGrid"));
    }
    static inline std::vector<std::uint32_t> words;
    static inline shared::OccupancyGrid grid;
    // Cells of 1/32 around (0, 0, 0), so that planes between them are exact.
    static void begin(int n) {
        words.assign(static_cast<size_t>(n) * n * n / 32, 0);
        grid = {};
        grid.cellSize = 1.0f / 32;
        grid.inverseCellSize = 32;
        grid.halfResolution = static_cast<float>(n) / 2;
        grid.resolution = static_cast<std::uint32_t>(n);
    }
    static void mark(const glm::ivec3& cell) {
        const int word = shared::occupancyWord(cell.x, cell.y, cell.z, static_cast<int>(grid.resolution));
        words.at(static_cast<size_t>(word)) |= 1u << (cell.z & 31);
    }
    [[nodiscard]] Declaration declare(const World&, const Inputs&, const Demand&) const override {
        Declaration declaration;
        declaration.outputs = {{.port = "occupancy", .desc = Desc::buffer(words.size() * 4, Format::R32UI)},
                               {.port = "grid", .desc = Desc::buffer(sizeof(shared::OccupancyGrid))}};
        declaration.steps = {{.name = "upload",
                              .uses = {{.port = "occupancy", .access = Access::Copy, .write = true},
                                       {.port = "grid", .access = Access::Copy, .write = true}}}};
        return declaration;
    }
    void execute(const Step&, Commands& commands) override {
        commands.upload("occupancy", words);
        commands.uploadValue("grid", grid);
    }
};

inline const Registry& registry() {
    static const Registry instance = [] {
        Registry made;
        made.add(OccupancyMap::type());
        made.add(Roma::type());
        made.add(RomaCascade::type());
        made.add(OccupancyTrace::type());
        made.add(MapSource::type());
        // What traces, as a user has it: from its plugin, which stays loaded.
        Registry plugins;
        for (const PluginResult& failure : loadPlugins(plugins, pluginFolders()))
            ADD_FAILURE() << failure.message;
        made.add(*plugins.find("RayQuery"));
        made.add(RaySource::type());
        made.shaderFolders = {test::sourceFolder() / "shaders"};
        return made;
    }();
    return instance;
}

inline std::vector<std::uint32_t> wordsOf(Renderer& renderer, const PortRef& port) {
    return as<std::uint32_t>(renderer.readBytes(port));
}

inline shared::OccupancyGrid gridOf(Renderer& renderer) {
    return as<shared::OccupancyGrid>(renderer.readBytes({"map", "grid"})).at(0);
}

inline bool isSet(const std::vector<std::uint32_t>& map, int n, const glm::ivec3& cell) {
    const int word = shared::occupancyWord(cell.x, cell.y, cell.z, n);
    return (map.at(static_cast<size_t>(word)) >> (cell.z & 31) & 1u) != 0;
}

inline size_t setBits(const std::vector<std::uint32_t>& map) {
    size_t count = 0;
    for (const std::uint32_t word : map) count += static_cast<size_t>(std::popcount(word));
    return count;
}

inline RenderOptions smallFrame(RenderOptions options = {}) {
    options.size = {16, 16, 1};
    return options;
}

// An OccupancyMap "map" with these properties (JSON members), its outputs wanted.
inline Renderer mapRenderer(Scene scene, const std::string& properties, RenderOptions options = {}) {
    const Graph graph =
        parseGraph(R"({"kestrel": 1, "passes": {"map": {"type": "OccupancyMap", "properties": {)" +
                       properties + R"(}}}, "outputs": ["map.occupancy", "map.grid"]})",
                   "test.json");
    return {graph, registry(), std::move(scene), context().capabilities(), smallFrame(std::move(options))};
}

// RaySource::rays through a Roma "roma" over a "map": hits at "query.hits". Properties as JSON members.
inline Renderer romaRenderer(Scene scene, const std::string& map, const std::string& roma,
                             const std::string& query, RenderOptions options = {}) {
    const Graph graph = parseGraph(R"({"kestrel": 1, "passes": {
            "map": {"type": "OccupancyMap", "properties": {)" +
                                       map + R"(}},
            "roma": {"type": "Roma", "properties": {)" +
                                       roma + R"(}},
            "rays": {"type": "RaySource"},
            "query": {"type": "RayQuery", "properties": {)" +
                                       query + R"(}}},
        "edges": [["map.occupancy", "roma.occupancy"], ["map.grid", "roma.grid"],
                  ["rays.rays", "query.rays"], ["roma.tracer", "query.tracer"]],
        "outputs": ["query.hits"]})",
                                   "test.json");
    for (const char* port : {"maps", "rotations", "directions"}) options.previews.push_back({"roma", port});
    for (const char* port : {"occupancy", "grid"}) options.previews.push_back({"map", port});
    return {graph, registry(), std::move(scene), context().capabilities(), smallFrame(std::move(options))};
}

inline shared::RayRecord rayRecord(const glm::vec3& origin, const glm::vec3& direction, float tMin = 0,
                                   float tMax = std::numeric_limits<float>::infinity(),
                                   const glm::vec3& normal = glm::vec3(0)) {
    shared::RayRecord record{};
    record.origin = origin;
    record.direction = glm::normalize(direction);
    record.tMin = tMin;
    record.tMax = tMax;
    record.normal = normal;
    record.flags = 1;
    return record;
}

inline constexpr double infinity = std::numeric_limits<double>::infinity();

// A ray in the cells of a map (one of several), in double precision.
struct AlignedRay {
    int map = 0;
    glm::dvec3 origin{0}, direction{0};
    double from = 0, to = 0;
};

// The ray's way through those of `cells` that it meets for more than `least` cells of its length: entry and
// exit, sorted.
inline std::vector<std::pair<double, double>> ways(const std::vector<glm::ivec3>& cells,
                                                   const AlignedRay& ray, double least) {
    std::vector<std::pair<double, double>> found;
    for (const glm::ivec3& corner : cells) {
        double enter = ray.from, leave = ray.to;
        const glm::dvec3 cell(corner);
        for (int k = 0; k < 3; ++k) {
            const double a = (cell[k] - ray.origin[k]) / ray.direction[k];
            const double b = (cell[k] + 1 - ray.origin[k]) / ray.direction[k];
            const bool along = std::abs(ray.direction[k]) < 1e-9;
            const bool within = ray.origin[k] >= cell[k] && ray.origin[k] <= cell[k] + 1;
            enter = std::max(enter, along ? (within ? -infinity : infinity) : std::min(a, b));
            leave = std::min(leave, along ? (within ? infinity : -infinity) : std::max(a, b));
        }
        if (leave - enter > least) found.emplace_back(enter, leave);
    }
    std::sort(found.begin(), found.end());
    return found;
}

// Rays of all kinds through a map around the unit ball: from inside and outside, along axes, bounded and not.
inline std::vector<shared::RayRecord> raysAround(int count, float scale, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto any = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
    std::vector<shared::RayRecord> rays;
    for (int i = 0; i < count; ++i) {
        glm::vec3 direction = any();
        if (i % 8 == 0)
            direction = glm::vec3(i % 3 == 0, i % 3 == 1, i % 3 == 2) * (i % 16 == 0 ? 1.0f : -1.0f);
        const float reach = i % 5 == 0 ? 3.0f : 1.0f; // some begin outside
        float tMin = 0, tMax = std::numeric_limits<float>::infinity();
        if (i % 3 == 1) tMax = 0.5f * (unit(random) + 1);
        if (i % 7 == 2) tMax = 0.002f; // within a cell
        if (i % 4 == 3) tMin = 0.2f * (unit(random) + 1);
        const glm::vec3 normal = i % 2 == 0 ? glm::normalize(any()) : glm::vec3(0);
        rays.push_back(rayRecord(reach * scale * any(), direction, scale * tMin, scale * tMax, normal));
    }
    return rays;
}

} // namespace kestrel::test
