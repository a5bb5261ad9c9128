// What the tests of the shipped passes share: the plugins as a user loads them, the shipped graphs, small
// scenes.
#pragma once
#include "core/files.h"
#include "execute/renderer.h"
#include "gl_fixture.h"
#include "plugin/loader.h"
#include "scene/geometry.h"
#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

namespace kestrel::test {

inline const Registry& shipped() {
    static const Registry instance = [] {
        Registry registry;
        const auto failures = loadPlugins(registry, pluginFolders());
        for (const PluginResult& failure : failures) ADD_FAILURE() << failure.message;
        return registry;
    }();
    return instance;
}

// A shipped graph with settings applied ("ao.tracer=bvh.tracer").
inline Graph shippedGraph(const std::string& name, const std::vector<std::string>& settings = {}) {
    Graph graph = loadGraph(shareFolder() / "graphs" / (name + ".json"));
    for (const std::string& setting : settings) applySetting(graph, shipped(), setting);
    return graph;
}

// With few cells and few rays of the references: for what does not depend on them.
inline Graph lightened(Graph graph, int cells = 32, int samples = 2) {
    for (const GraphPass& pass : Graph(graph).passes) {
        const PassType* type = shipped().find(pass.type);
        if (pass.type == "OccupancyMap")
            applySetting(graph, shipped(), fmt::format("{}.resolution={}", pass.name, cells));
        if (type != nullptr && type->property("samples") != nullptr && pass.type.starts_with("Reference"))
            applySetting(graph, shipped(), fmt::format("{}.samples={}", pass.name, samples));
    }
    return graph;
}

inline std::vector<std::string> shippedGraphNames() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(shareFolder() / "graphs"))
        if (entry.path().extension() == ".json" && entry.path().stem() != "schema")
            names.push_back(entry.path().stem());
    std::sort(names.begin(), names.end());
    return names;
}

// Triangles, three corners each, one double-sided material.
inline Scene trianglesScene(std::vector<glm::vec3> corners, const glm::dmat4& rootTransform = glm::dmat4(1)) {
    Scene scene;
    scene.name = "triangles";
    if (!corners.empty()) {
        Primitive primitive;
        for (std::uint32_t i = 0; i < corners.size(); ++i) primitive.indices.push_back(i);
        for (size_t i = 0; i < corners.size(); i += 3) {
            const glm::vec3 face = glm::cross(corners[i + 1] - corners[i], corners[i + 2] - corners[i]);
            const float area = glm::length(face);
            for (int k = 0; k < 3; ++k)
                primitive.normals.push_back(area > 0 ? face / area : glm::vec3(0, 0, 1));
        }
        primitive.positions = std::move(corners);
        primitive.material = 0;
        Material material;
        material.doubleSided = true;
        scene.materials.push_back(material);
        scene.meshes.push_back({"mesh", {primitive}, {}});
        Node node;
        node.mesh = 0;
        scene.nodes.push_back(node);
        scene.roots = {0};
    }
    scene.rootTransform = rootTransform;
    finishScene(scene);
    return scene;
}

// The square [-1, 1]^2 in the plane z = 0, turned.
inline std::vector<glm::vec3> square(const glm::mat3& turn = glm::mat3(1)) {
    const glm::vec3 a = turn * glm::vec3(-1, -1, 0), b = turn * glm::vec3(1, -1, 0),
                    c = turn * glm::vec3(1, 1, 0), d = turn * glm::vec3(-1, 1, 0);
    return {a, b, c, a, c, d};
}

// A scene moved and scaled as a whole.
inline Scene transformed(const std::string& source, const glm::dmat4& transform) {
    Scene scene = loadScene(source);
    scene.rootTransform = transform * scene.rootTransform;
    finishScene(scene);
    return scene;
}

struct ShippedTest : GlTest {
    static Renderer renderer(Graph graph, Scene scene, RenderOptions options = {},
                             Extent size = {96, 54, 1}) {
        options.size = size;
        return {std::move(graph), shipped(), std::move(scene), context().capabilities(), std::move(options)};
    }
    static Image render(Graph graph, Scene scene, const PortRef& port, int frames = 1,
                        RenderOptions options = {}, Extent size = {96, 54, 1}) {
        Renderer made = renderer(std::move(graph), std::move(scene), std::move(options), size);
        for (int i = 0; i < frames; ++i) made.frame();
        return made.read(port);
    }
};

// Mean of the pixels where `mask` is above 0.
inline double meanWhere(const Image& image, const Image& mask) {
    double sum = 0, count = 0;
    for (size_t i = 0; i < image.pixelCount(); ++i)
        if (mask.values[i * static_cast<size_t>(mask.channels)] > 0) {
            sum += image.values[i * static_cast<size_t>(image.channels)];
            ++count;
        }
    return count > 0 ? sum / count : 0;
}

// Root mean square and largest difference of two images of one size.
struct Difference {
    double rms = 0, largest = 0;
};
inline Difference difference(const Image& a, const Image& b) {
    EXPECT_EQ(a.sizeText(), b.sizeText());
    EXPECT_EQ(a.channels, b.channels);
    Difference result;
    for (size_t i = 0; i < std::min(a.values.size(), b.values.size()); ++i) {
        const double d = std::abs(double{a.values[i]} - double{b.values[i]});
        result.rms += d * d;
        result.largest = std::max(result.largest, d);
    }
    result.rms = std::sqrt(result.rms / static_cast<double>(std::max<size_t>(1, a.values.size())));
    return result;
}

} // namespace kestrel::test
