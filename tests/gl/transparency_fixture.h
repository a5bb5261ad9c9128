// Blended squares before each other, and graphs that composite them.
#pragma once
#include "shipped_fixture.h"

namespace kestrel::test {

// A square of half size 2 about the z axis, seen from +z.
struct Pane {
    float z = 0;
    glm::vec4 colour{1};
    AlphaMode mode = AlphaMode::Blend;
    bool doubleSided = true;
    bool turned = false; // shows its back
};

// Unlit panes: what they show is their colour. The camera looks along -z from z = 4.
inline Scene panesScene(const std::vector<Pane>& panes) {
    Scene scene;
    scene.name = "panes";
    for (const Pane& pane : panes) {
        Material material;
        material.baseColour = pane.colour;
        material.alphaMode = pane.mode;
        material.doubleSided = pane.doubleSided;
        material.unlit = true;
        Primitive primitive;
        for (const glm::vec3& corner : square()) {
            primitive.positions.push_back(2.0f * (pane.turned ? glm::vec3(-corner.x, corner.y, 0) : corner) +
                                          glm::vec3(0, 0, pane.z));
            primitive.normals.emplace_back(0, 0, pane.turned ? -1 : 1);
            primitive.indices.push_back(static_cast<std::uint32_t>(primitive.indices.size()));
        }
        primitive.material = static_cast<int>(scene.materials.size());
        scene.materials.push_back(material);
        Node node;
        node.mesh = static_cast<int>(scene.meshes.size());
        scene.meshes.push_back({"pane", {primitive}, {}});
        scene.roots.push_back(static_cast<int>(scene.nodes.size()));
        scene.nodes.push_back(node);
    }
    Camera camera;
    camera.name = "front";
    Node node;
    node.camera = 0;
    node.translation = {0, 0, 4};
    camera.node = static_cast<int>(scene.nodes.size());
    scene.cameras = {camera};
    scene.roots.push_back(static_cast<int>(scene.nodes.size()));
    scene.nodes.push_back(node);
    finishScene(scene);
    return scene;
}

// What the panes leave of `behind`, from the far end on; `panes` from the nearest on.
inline glm::vec3 over(const std::vector<glm::vec4>& panes, glm::vec3 behind) {
    for (size_t i = panes.size(); i-- > 0;)
        behind = panes[i].a * glm::vec3(panes[i]) + (1 - panes[i].a) * behind;
    return behind;
}

inline const PortRef exactly{"transparent", "result"}, weighted{"weighted", "result"},
    opaquely{"composite", "result"}, truly{"truth", "result"}, surfacesMet{"truth", "surfaces"};

// The shipped graph, with the reference beside; constant surroundings.
inline Graph transparencyGraph(const std::vector<PortRef>& outputs,
                               const std::vector<std::string>& settings = {}) {
    Graph graph = shippedGraph("transparency");
    if (shipped().find("ReferenceTransparency") != nullptr) {
        Graph truth = parseGraph(R"({"kestrel": 1, "passes": {"composite": {"type": "Composite"},
            "truth": {"type": "ReferenceTransparency"}},
            "edges": [["composite.result", "truth.picture"]], "outputs": []})",
                                 "test.json");
        graph.passes.push_back(truth.passes.back());
        graph.edges.push_back(truth.edges.back());
    }
    for (const char* setting : {"sky.kind=constant", "composite.ambient=[0,0,0]",
                                "transparent.ambient=[0,0,0]", "weighted.ambient=[0,0,0]"})
        applySetting(graph, shipped(), setting);
    for (const std::string& setting : settings) applySetting(graph, shipped(), setting);
    graph.outputs.clear();
    for (const PortRef& output : outputs) graph.outputs.push_back({output, {}});
    return graph;
}

struct TransparencyTest : ShippedTest {
    // One frame of several outputs.
    static std::vector<Image> made(const Scene& scene, const std::vector<PortRef>& outputs,
                                   const std::vector<std::string>& settings = {}, Extent size = {96, 54, 1},
                                   const std::string& camera = {}) {
        RenderOptions options;
        options.checkFinite = options.countIterations = true;
        if (!camera.empty()) options.camera = camera;
        Renderer renderer =
            TransparencyTest::renderer(transparencyGraph(outputs, settings), scene, options, size);
        renderer.frame();
        std::vector<Image> images;
        for (const PortRef& output : outputs) images.push_back(renderer.read(output));
        return images;
    }
};

inline glm::vec3 middleOf(const Image& image) {
    const int x = image.width / 2, y = image.height / 2;
    return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
}

// The share of pixels that differ by more than 2/255 in any channel, as pictures of light from 0 to 1.
inline double shareApart(const Image& a, const Image& b) {
    size_t apart = 0;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            float most = 0;
            for (int k = 0; k < 3; ++k)
                most =
                    std::max(most, std::abs(std::min(a.at(x, y, k), 1.0f) - std::min(b.at(x, y, k), 1.0f)));
            apart += most > 2.0f / 255 ? 1 : 0;
        }
    return static_cast<double>(apart) / static_cast<double>(a.pixelCount());
}

} // namespace kestrel::test
