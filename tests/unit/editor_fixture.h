// A small table of pass types for tests of the editor.
#pragma once
#include "edit/commands.h"
#include "graph_mock.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel::test {

class Tuned final : public Pass {
public:
    int rays = 1;
    float radius = 0.5f;
    bool snap = false;
    Declaration declare(const World&, const Inputs&, const Demand&) const override { return {}; }
    void execute(const Step&, Commands&) override {}
};

class WideTuned final : public Pass {
public:
    float radius = 5;
    Declaration declare(const World&, const Inputs&, const Demand&) const override { return {}; }
    void execute(const Step&, Commands&) override {}
};

inline Registry editorRegistry() {
    Registry registry;
    const Declare none = [](const World&, const Inputs&, const Demand&) { return Declaration(); };
    registry.add(mockType("GBuffer", {out("depth"), out("normal"), out("colour")}, none));
    registry.add(mockType("Map", {out("occupancy", PortKind::Buffer)}, none));
    registry.add(
        mockType("Roma", {in("occupancy", PortKind::Buffer), out("tracer", PortKind::Tracer)}, none));
    registry.add(mockType(
        "Field",
        {in("occupancy", PortKind::Buffer), opt("surface", PortKind::Hits), out("tracer", PortKind::Tracer)},
        none));
    registry.add(mockType("Bvh", {out("tracer", PortKind::Tracer), out("hits", PortKind::Hits)}, none));
    registry.add(Describe<Tuned>("RayOcclusion", "Ambient occlusion by rays")
                     .input("tracer", PortKind::Tracer, "Traces")
                     .input("depth", PortKind::Texture, "Depth")
                     .optionalInput("normal", PortKind::Texture, "Normals")
                     .output("visibility", PortKind::Texture, "Visibility")
                     .number("rays", &Tuned::rays, 1, 64, "rays", "A pixel")
                     .number("radius", &Tuned::radius, 0, 10, "scene units", "How far")
                     .flag("snap", &Tuned::snap, "Snaps"));
    registry.add(Describe<WideTuned>("WideOcclusion", "The same, wider")
                     .input("tracer", PortKind::Tracer, "Traces")
                     .input("depth", PortKind::Texture, "Depth")
                     .output("visibility", PortKind::Texture, "Visibility")
                     .number("radius", &WideTuned::radius, 1, 100, "scene units", "How far"));
    registry.add(mockType("Blur", {in("signal"), opt("guide"), out("result")}, none));
    return registry;
}

inline const char* editorGraph = R"({
  "kestrel": 1,
  "name": "Occlusion",
  "scene": { "source": "builtin:tower" },
  "variables": { "reach": 0.5 },
  "passes": {
    "gbuffer": { "type": "GBuffer", "position": [0, 0] },
    "map": { "type": "Map", "position": [0, 200] },
    "roma": { "type": "Roma", "position": [200, 200] },
    "bvh": { "type": "Bvh", "position": [200, 400] },
    "ao": { "type": "RayOcclusion", "properties": { "rays": 4, "radius": { "variable": "reach" } }, "position": [400, 100] },
    "blur": { "type": "Blur", "position": [600, 100] }
  },
  "edges": [
    ["map.occupancy", "roma.occupancy"],
    ["roma.tracer", "ao.tracer", [[300, 150]]],
    ["gbuffer.depth", "ao.depth"],
    ["gbuffer.normal", "ao.normal"],
    ["ao.visibility", "blur.signal"]
  ],
  "outputs": ["blur.result"],
  "frames": [
    { "title": "Tracing", "passes": ["map", "roma"] }
  ],
  "notes": [
    { "text": "Try the field", "position": [10, 500] }
  ]
}
)";

inline Graph editedGraph() { return parseGraph(editorGraph, "g.json"); }

inline std::vector<std::string> edgesOf(const Graph& graph) {
    std::vector<std::string> texts;
    for (const GraphEdge& edge : graph.edges) texts.push_back(edge.from.text() + " -> " + edge.to.text());
    return texts;
}

inline std::string refusal(const std::function<void()>& command) { return messageOf(command); }

// Commands keep what can be saved and read again.
inline void expectWhole(const Graph& graph) {
    const std::string text = saveGraph(graph);
    EXPECT_EQ(saveGraph(parseGraph(text, "again")), text);
}

} // namespace kestrel::test
