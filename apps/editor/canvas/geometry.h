// Where everything on the canvas lies, and what lies under the pointer. No drawing: it is tested as it is.
// Canvas units are the document's; at zoom 1 one is a screen pixel. y goes down.
#pragma once
#include "edit/layout.h"
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace kestrel::edit {

// Width of a text in canvas units.
using TextWidth = std::function<double(const std::string&)>;

struct PortPlace {
    PortRef port;
    PortKind kind = PortKind::Texture;
    bool input = false, optional = false;
    glm::dvec2 at; // its middle, on the left or right edge of the box
};

struct Box {
    std::string pass;
    glm::dvec2 low, high;
    std::vector<PortPlace> ports;
    [[nodiscard]] const PortPlace* find(const PortRef& port) const;
    [[nodiscard]] bool contains(glm::dvec2 point) const;
};

namespace look {
inline constexpr double header = 40; // name and type
inline constexpr double line = 20;   // of a port
inline constexpr double margin = 10, minWidth = 130, portRadius = 5;
inline constexpr double frameMargin = 16, frameTitle = 24;
} // namespace look

// The boxes in the order of the document; a pass without a position lies at the origin. A pass of an unknown
// type has the ports that edges name.
std::vector<Box> boxesOf(const Graph& graph, const Registry& registry, const TextWidth& width);
Sizes sizesOf(const std::vector<Box>& boxes);
const Box* boxOf(const std::vector<Box>& boxes, const std::string& pass);
// Around the boxes of a frame's passes, with its title above; nothing if it has none.
std::optional<Box> frameBox(const GraphFrame& frame, const std::vector<Box>& boxes);
// Around everything; nothing if there is nothing.
std::optional<std::pair<glm::dvec2, glm::dvec2>> bounds(const Graph& graph, const std::vector<Box>& boxes);

// The curve of an edge as a chain of points, through its bends; empty if an end is not there.
std::vector<glm::dvec2> curveOf(const GraphEdge& edge, const std::vector<Box>& boxes);
// Of all edges, in the order of the document.
struct Curve {
    std::vector<glm::dvec2> points;
    PortKind kind = PortKind::Texture;
};
using Curves = std::vector<Curve>;
Curves curvesOf(const Graph& graph, const std::vector<Box>& boxes);
// From one place to another, leaving rightward and arriving from the left.
std::vector<glm::dvec2> curveBetween(glm::dvec2 from, glm::dvec2 to);

// How the canvas is looked at: a screen point is (canvas - origin) * zoom.
struct CanvasView {
    glm::dvec2 origin{0};
    double zoom = 1;
    static constexpr double minZoom = 0.1, maxZoom = 4;
    [[nodiscard]] glm::dvec2 toScreen(glm::dvec2 canvas) const { return (canvas - origin) * zoom; }
    [[nodiscard]] glm::dvec2 toCanvas(glm::dvec2 screen) const { return screen / zoom + origin; }
    // The canvas point under `screen` stays there.
    void zoomAt(glm::dvec2 screen, double factor);
    void pan(glm::dvec2 screen) { origin -= screen / zoom; }
    // So that the area fills a window of `size` pixels, with a margin; at zoom `closest` at most.
    void show(glm::dvec2 low, glm::dvec2 high, glm::dvec2 size, double closest = 1);
};

struct Hit {
    enum class Kind { Nothing, Port, Pass, Edge, Bend, Frame, Note };
    Kind kind = Kind::Nothing;
    std::string pass = {};
    PortRef port = {};      // a port, or the input of an edge
    size_t index = 0;       // of a bend, a frame, a note
    bool nearBegin = false; // of an edge: nearer to its output than to its input
};

// What lies under a screen point. Ports go before all else and are at least 12 pixels wide at any zoom: of
// several in reach the nearest. Then bends, boxes (the last in the document lies on top), edges within 6
// pixels, notes, titles of frames. `curves` are those of the graph, where they are known already.
Hit hitAt(const Graph& graph, const std::vector<Box>& boxes, const CanvasView& view, glm::dvec2 screen,
          const Curves* curves = nullptr);

// Passes whose boxes a rectangle of the canvas touches.
Names passesIn(const std::vector<Box>& boxes, glm::dvec2 a, glm::dvec2 b);
// The inputs of the edges that a stroke crosses.
std::vector<PortRef> edgesAcross(const Graph& graph, const std::vector<Box>& boxes, glm::dvec2 a,
                                 glm::dvec2 b);

} // namespace kestrel::edit
