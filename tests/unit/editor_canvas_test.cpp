#include "canvas/geometry.h"
#include "edit/problems.h"
#include "editor_fixture.h"

namespace kestrel::edit {
namespace {

using namespace test;
using testing::ElementsAre;

class EditorCanvas : public testing::Test {
protected:
    const Registry registry = editorRegistry();
    const Graph graph = editedGraph();
    const std::vector<Box> boxes =
        boxesOf(graph, registry, [](const std::string& text) { return 7.0 * text.size(); });
    const PortPlace& port(const std::string& pass, const std::string& name) const {
        return *boxOf(boxes, pass)->find({pass, name});
    }
};

TEST_F(EditorCanvas, PortsStandOnTheEdgesOfTheirBoxes) {
    ASSERT_EQ(boxes.size(), graph.passes.size());
    for (const Box& box : boxes) {
        for (const PortPlace& place : box.ports) {
            EXPECT_EQ(place.at.x, place.input ? box.low.x : box.high.x);
            EXPECT_GT(place.at.y, box.low.y + look::header);
            EXPECT_LT(place.at.y, box.high.y);
        }
    }
    EXPECT_EQ(port("ao", "tracer").kind, PortKind::Tracer);
    EXPECT_TRUE(port("ao", "normal").optional);
    EXPECT_EQ(port("ao", "depth").at.y - port("ao", "tracer").at.y, look::line);
}

// At any zoom a port can be hit within 6 pixels of its middle, and of neighbours the nearest answers.
TEST_F(EditorCanvas, PortsAreTwelvePixelsWideAtAnyZoom) {
    for (const double zoom : {CanvasView::minZoom, 0.25, 0.5, 1.0, 2.0, CanvasView::maxZoom}) {
        CanvasView view;
        view.zoom = zoom;
        for (const Box& box : boxes)
            for (const PortPlace& place : box.ports) {
                const glm::dvec2 middle = view.toScreen(place.at);
                EXPECT_EQ(hitAt(graph, boxes, view, middle).port, place.port) << zoom;
                // Away from the box and from other ports.
                const glm::dvec2 beside = middle + glm::dvec2(place.input ? -5.9 : 5.9, 0);
                const Hit hit = hitAt(graph, boxes, view, beside);
                EXPECT_EQ(hit.kind, Hit::Kind::Port) << place.port.text() << " at zoom " << zoom;
                if (zoom >= 0.5) {
                    EXPECT_EQ(hit.port, place.port) << zoom;
                }
            }
    }
}

TEST_F(EditorCanvas, WhatLiesUnderThePointer) {
    const CanvasView view;
    EXPECT_EQ(hitAt(graph, boxes, view, {20, 20}).pass, "gbuffer");
    EXPECT_EQ(hitAt(graph, boxes, view, {300, 150}).kind, Hit::Kind::Bend);
    const Hit note = hitAt(graph, boxes, view, {20, 510});
    EXPECT_EQ(note.kind, Hit::Kind::Note);
    const auto frame = frameBox(graph.frames[0], boxes);
    ASSERT_TRUE(frame);
    EXPECT_EQ(hitAt(graph, boxes, view, frame->low + 3.0).kind, Hit::Kind::Frame);
    EXPECT_EQ(hitAt(graph, boxes, view, {-500, -500}).kind, Hit::Kind::Nothing);
    // An edge answers along its whole way, and says which end is nearer.
    const GraphEdge& edge = graph.edges[4];
    const std::vector<glm::dvec2> curve = curveOf(edge, boxes);
    const Hit begin = hitAt(graph, boxes, view, curve[5]), end = hitAt(graph, boxes, view, curve[11]);
    EXPECT_EQ(begin.kind, Hit::Kind::Edge);
    EXPECT_EQ(begin.port, edge.to);
    EXPECT_TRUE(begin.nearBegin);
    EXPECT_FALSE(end.nearBegin);
}

TEST_F(EditorCanvas, AnEdgeGoesThroughItsBends) {
    const std::vector<glm::dvec2> curve = curveOf(graph.edges[1], boxes);
    EXPECT_EQ(curve.front(), port("roma", "tracer").at);
    EXPECT_EQ(curve.back(), port("ao", "tracer").at);
    EXPECT_NE(std::find(curve.begin(), curve.end(), glm::dvec2(300, 150)), curve.end());
}

// (7) Pan and zoom keep what is under the pointer.
TEST_F(EditorCanvas, ZoomingKeepsThePointUnderThePointer) {
    CanvasView view;
    const glm::dvec2 pointer(300, 200);
    for (const double factor : {1.25, 1.25, 0.5, 0.1, 0.1, 40.0, 3.0}) {
        const glm::dvec2 before = view.toCanvas(pointer);
        view.zoomAt(pointer, factor);
        EXPECT_NEAR(glm::length(view.toCanvas(pointer) - before), 0, 1e-9);
        EXPECT_GE(view.zoom, CanvasView::minZoom);
        EXPECT_LE(view.zoom, CanvasView::maxZoom);
        view.pan({10, -20});
        EXPECT_NEAR(glm::length(view.toCanvas(pointer + glm::dvec2(10, -20)) - before), 0, 1e-9);
    }
    const auto all = bounds(graph, boxes);
    ASSERT_TRUE(all);
    view.show(all->first, all->second, {640, 480});
    for (const glm::dvec2 corner : {all->first, all->second}) {
        const glm::dvec2 screen = view.toScreen(corner);
        EXPECT_TRUE(screen.x >= 0 && screen.x <= 640 && screen.y >= 0 && screen.y <= 480);
    }
}

TEST_F(EditorCanvas, ABoxSelectsAndAStrokeCuts) {
    EXPECT_EQ(passesIn(boxes, {-10, -10}, {10, 210}), (Names{"gbuffer", "map"}));
    EXPECT_EQ(passesIn(boxes, {10, 210}, {-10, -10}), (Names{"gbuffer", "map"}));
    const glm::dvec2 from = port("ao", "visibility").at, to = port("blur", "signal").at;
    const glm::dvec2 middle = (from + to) * 0.5;
    EXPECT_THAT(edgesAcross(graph, boxes, middle - glm::dvec2(0, 60), middle + glm::dvec2(0, 60)),
                ElementsAre(PortRef{"blur", "signal"}));
    EXPECT_TRUE(edgesAcross(graph, boxes, {-100, -100}, {-90, 900}).empty());
}

TEST_F(EditorCanvas, AMistakeStandsWhereItBelongs) {
    Graph wrong = graph;
    wrong.find("ao")->properties[0].second = std::int64_t{1'000};
    wrong.edges[3].from = {"bvh", "tracer"}; // into ao.normal
    std::erase_if(wrong.edges, [](const GraphEdge& edge) { return edge.to.pass == "blur"; });
    const Graph located = locatedGraph(wrong, saveGraph(wrong));
    const std::vector<Marked> marked = mark(located, validate(located, registry));
    ASSERT_EQ(marked.size(), 3u);
    EXPECT_EQ(marked[0].pass + "." + marked[0].property, "ao.rays");
    EXPECT_EQ(marked[1].pass, "blur");
    EXPECT_EQ(marked[2].input, (PortRef{"ao", "normal"}));
    EXPECT_EQ(mark(located, {{{}, "shader of 'ao': no"}})[0].pass, "ao");
    EXPECT_EQ(mark(located, {{{}, "'x', 'blur.result' and more"}})[0].pass, "blur");
    EXPECT_EQ(mark(located, {{{}, "nothing of ours"}})[0].pass, "");
}

} // namespace
} // namespace kestrel::edit
