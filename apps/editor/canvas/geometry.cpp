#include "canvas/geometry.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <unordered_map>

namespace kestrel::edit {
namespace {

constexpr double noteWidth = 200, noteHeight = 60;

void addPort(Box& box, const PortRef& port, PortKind kind, bool input, bool optional) {
    size_t row = 0;
    for (const PortPlace& place : box.ports) row += place.input == input ? 1 : 0;
    const double y = box.low.y + look::header + look::line * (static_cast<double>(row) + 0.5);
    box.ports.push_back({port, kind, input, optional, {input ? box.low.x : box.high.x, y}});
}

double widthOf(const GraphPass& pass, const PassType* type, const TextWidth& width) {
    double inputs = 0, outputs = 0;
    if (type != nullptr)
        for (const PortInfo& port : type->ports) {
            if (port.direction == PortDirection::Input) inputs = std::max(inputs, width(port.name));
            if (port.direction == PortDirection::Output) outputs = std::max(outputs, width(port.name));
        }
    const double titles = std::max(width(pass.name), width(pass.type));
    return std::max({look::minWidth, titles + 2 * look::margin, inputs + outputs + 4 * look::margin});
}

double distanceTo(const std::vector<glm::dvec2>& curve, glm::dvec2 point, double& along) {
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i + 1 < curve.size(); ++i) {
        const glm::dvec2 piece = curve[i + 1] - curve[i];
        const double length = glm::dot(piece, piece);
        const double t = length > 0 ? std::clamp(glm::dot(point - curve[i], piece) / length, 0.0, 1.0) : 0;
        const double distance = glm::length(point - curve[i] - t * piece);
        if (distance >= nearest) continue;
        nearest = distance;
        along = (static_cast<double>(i) + t) / static_cast<double>(curve.size() - 1);
    }
    return nearest;
}

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

// Half-open, so that a stroke through the point where two pieces of a curve meet crosses one of them.
bool crosses(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
    const auto apart = [](glm::dvec2 from, glm::dvec2 to, glm::dvec2 p, glm::dvec2 q) {
        return (cross(to - from, p - from) < 0) != (cross(to - from, q - from) < 0);
    };
    return apart(a, b, c, d) && apart(c, d, a, b);
}

Hit portAt(const std::vector<Box>& boxes, const CanvasView& view, glm::dvec2 screen) {
    // Twelve pixels wide at least, whatever the zoom.
    double nearest = std::max(6.0, look::portRadius * 1.6 * view.zoom);
    Hit hit;
    for (const Box& box : boxes)
        for (const PortPlace& place : box.ports) {
            const double distance = glm::length(view.toScreen(place.at) - screen);
            if (distance > nearest) continue;
            nearest = distance;
            hit = {.kind = Hit::Kind::Port, .pass = box.pass, .port = place.port, .index = 0};
        }
    return hit;
}

Hit edgeAt(const Graph& graph, const Curves& curves, const CanvasView& view, glm::dvec2 point) {
    double nearest = 6 / view.zoom;
    Hit hit;
    for (size_t i = 0; i < curves.size(); ++i) {
        double along = 0;
        const double distance = distanceTo(curves[i].points, point, along);
        if (distance > nearest) continue;
        nearest = distance;
        hit = {.kind = Hit::Kind::Edge,
               .pass = {},
               .port = graph.edges[i].to,
               .index = 0,
               .nearBegin = along < 0.5};
    }
    return hit;
}

} // namespace

const PortPlace* Box::find(const PortRef& port) const {
    const auto found =
        std::find_if(ports.begin(), ports.end(), [&](const PortPlace& place) { return place.port == port; });
    return found == ports.end() ? nullptr : &*found;
}

bool Box::contains(glm::dvec2 point) const {
    return point.x >= low.x && point.x <= high.x && point.y >= low.y && point.y <= high.y;
}

std::vector<Box> boxesOf(const Graph& graph, const Registry& registry, const TextWidth& width) {
    std::vector<Box> boxes;
    for (const GraphPass& pass : graph.passes) {
        const PassType* type = registry.find(pass.type);
        Box box{.pass = pass.name, .low = pass.position.value_or(glm::dvec2(0)), .high = {}, .ports = {}};
        box.high.x = box.low.x + widthOf(pass, type, width);
        if (type != nullptr) {
            for (const PortInfo& port : type->ports)
                if (port.direction != PortDirection::Internal)
                    addPort(box, {pass.name, port.name}, port.kind, port.direction == PortDirection::Input,
                            port.optional);
        } else {
            for (const GraphEdge& edge : graph.edges) {
                if (edge.to.pass == pass.name && box.find(edge.to) == nullptr)
                    addPort(box, edge.to, PortKind::Texture, true, false);
                if (edge.from.pass == pass.name && box.find(edge.from) == nullptr)
                    addPort(box, edge.from, PortKind::Texture, false, false);
            }
        }
        size_t rows = 0, inputs = 0;
        for (const PortPlace& place : box.ports) inputs += place.input ? 1 : 0;
        rows = std::max(inputs, box.ports.size() - inputs);
        box.high.y = box.low.y + look::header + look::line * static_cast<double>(rows) + look::margin / 2;
        boxes.push_back(std::move(box));
    }
    return boxes;
}

Sizes sizesOf(const std::vector<Box>& boxes) {
    Sizes sizes;
    for (const Box& box : boxes) sizes[box.pass] = box.high - box.low;
    return sizes;
}

const Box* boxOf(const std::vector<Box>& boxes, const std::string& pass) {
    const auto found =
        std::find_if(boxes.begin(), boxes.end(), [&](const Box& box) { return box.pass == pass; });
    return found == boxes.end() ? nullptr : &*found;
}

std::optional<Box> frameBox(const GraphFrame& frame, const std::vector<Box>& boxes) {
    std::optional<Box> around;
    for (const std::string& pass : frame.passes)
        if (const Box* box = boxOf(boxes, pass)) {
            if (!around) around = Box{.pass = frame.title, .low = box->low, .high = box->high, .ports = {}};
            around->low = glm::min(around->low, box->low);
            around->high = glm::max(around->high, box->high);
        }
    if (!around) return {};
    around->low -= glm::dvec2(look::frameMargin, look::frameMargin + look::frameTitle);
    around->high += glm::dvec2(look::frameMargin);
    return around;
}

std::optional<std::pair<glm::dvec2, glm::dvec2>> bounds(const Graph& graph, const std::vector<Box>& boxes) {
    std::optional<std::pair<glm::dvec2, glm::dvec2>> all;
    const auto add = [&](glm::dvec2 low, glm::dvec2 high) {
        all = all ? std::pair(glm::min(all->first, low), glm::max(all->second, high)) : std::pair(low, high);
    };
    for (const Box& box : boxes) add(box.low, box.high);
    for (const GraphFrame& frame : graph.frames)
        if (const auto box = frameBox(frame, boxes)) add(box->low, box->high);
    for (const GraphNote& note : graph.notes)
        add(note.position, note.position + glm::dvec2(noteWidth, noteHeight));
    return all;
}

std::vector<glm::dvec2> curveBetween(glm::dvec2 from, glm::dvec2 to) {
    // Back to the left the handles grow with the way, so that the wire swings around its boxes.
    const double reach = std::clamp(std::abs(to.x - from.x) * 0.5, 30.0, 200.0);
    const glm::dvec2 a = from + glm::dvec2(reach, 0), b = to - glm::dvec2(reach, 0);
    std::vector<glm::dvec2> points;
    constexpr int pieces = 16;
    for (int i = 0; i <= pieces; ++i) {
        const double t = static_cast<double>(i) / pieces, s = 1 - t;
        points.push_back(s * s * s * from + 3 * s * s * t * a + 3 * s * t * t * b + t * t * t * to);
    }
    return points;
}

namespace {

std::vector<glm::dvec2> curve(const GraphEdge& edge, const Box* fromBox, const Box* toBox) {
    const PortPlace* from = fromBox != nullptr ? fromBox->find(edge.from) : nullptr;
    const PortPlace* to = toBox != nullptr ? toBox->find(edge.to) : nullptr;
    if (from == nullptr || to == nullptr) return {};
    std::vector<glm::dvec2> stops = {from->at};
    stops.insert(stops.end(), edge.bends.begin(), edge.bends.end());
    stops.push_back(to->at);
    std::vector<glm::dvec2> points;
    for (size_t i = 0; i + 1 < stops.size(); ++i) {
        const std::vector<glm::dvec2> piece = curveBetween(stops[i], stops[i + 1]);
        points.insert(points.end(), piece.begin() + (i > 0 ? 1 : 0), piece.end());
    }
    return points;
}

} // namespace

std::vector<glm::dvec2> curveOf(const GraphEdge& edge, const std::vector<Box>& boxes) {
    return curve(edge, boxOf(boxes, edge.from.pass), boxOf(boxes, edge.to.pass));
}

Curves curvesOf(const Graph& graph, const std::vector<Box>& boxes) {
    std::unordered_map<std::string_view, const Box*> byPass;
    for (const Box& box : boxes) byPass.emplace(box.pass, &box);
    const auto of = [&](const std::string& pass) {
        const auto found = byPass.find(pass);
        return found == byPass.end() ? nullptr : found->second;
    };
    Curves curves;
    for (const GraphEdge& edge : graph.edges) {
        const Box* from = of(edge.from.pass);
        const PortPlace* place = from != nullptr ? from->find(edge.from) : nullptr;
        curves.push_back(
            {curve(edge, from, of(edge.to.pass)), place != nullptr ? place->kind : PortKind::Texture});
    }
    return curves;
}

void CanvasView::zoomAt(glm::dvec2 screen, double factor) {
    const glm::dvec2 fixed = toCanvas(screen);
    zoom = std::clamp(zoom * factor, minZoom, maxZoom);
    origin = fixed - screen / zoom;
}

void CanvasView::show(glm::dvec2 low, glm::dvec2 high, glm::dvec2 size, double closest) {
    constexpr double margin = 30;
    const glm::dvec2 area = glm::max(high - low, glm::dvec2(1)),
                     room = glm::max(size - 2 * margin, glm::dvec2(1));
    zoom = std::clamp(std::min(room.x / area.x, room.y / area.y), minZoom, closest);
    origin = (low + high) * 0.5 - size * 0.5 / zoom;
}

Hit hitAt(const Graph& graph, const std::vector<Box>& boxes, const CanvasView& view, glm::dvec2 screen,
          const Curves* curves) {
    if (Hit port = portAt(boxes, view, screen); port.kind != Hit::Kind::Nothing) return port;
    const glm::dvec2 point = view.toCanvas(screen);
    for (const GraphEdge& bent : graph.edges)
        for (size_t i = 0; i < bent.bends.size(); ++i)
            if (glm::length(view.toScreen(bent.bends[i]) - screen) <= 6)
                return {.kind = Hit::Kind::Bend, .pass = {}, .port = bent.to, .index = i};
    for (auto box = boxes.rbegin(); box != boxes.rend(); ++box)
        if (box->contains(point)) return {.kind = Hit::Kind::Pass, .pass = box->pass, .port = {}, .index = 0};
    const Hit edge = edgeAt(graph, curves != nullptr ? *curves : curvesOf(graph, boxes), view, point);
    if (edge.kind != Hit::Kind::Nothing) return edge;
    for (size_t i = graph.notes.size(); i-- > 0;) {
        const glm::dvec2 low = graph.notes[i].position;
        if (Box{.pass = {}, .low = low, .high = low + glm::dvec2(noteWidth, noteHeight), .ports = {}}
                .contains(point))
            return {.kind = Hit::Kind::Note, .pass = {}, .port = {}, .index = i};
    }
    for (size_t i = graph.frames.size(); i-- > 0;)
        if (auto box = frameBox(graph.frames[i], boxes)) {
            box->high.y = box->low.y + look::frameTitle;
            if (box->contains(point)) return {.kind = Hit::Kind::Frame, .pass = {}, .port = {}, .index = i};
        }
    return {};
}

Names passesIn(const std::vector<Box>& boxes, glm::dvec2 a, glm::dvec2 b) {
    const glm::dvec2 low = glm::min(a, b), high = glm::max(a, b);
    Names names;
    for (const Box& box : boxes)
        if (box.high.x >= low.x && box.low.x <= high.x && box.high.y >= low.y && box.low.y <= high.y)
            names.insert(box.pass);
    return names;
}

std::vector<PortRef> edgesAcross(const Graph& graph, const std::vector<Box>& boxes, glm::dvec2 a,
                                 glm::dvec2 b) {
    std::vector<PortRef> inputs;
    const Curves curves = curvesOf(graph, boxes);
    for (size_t e = 0; e < curves.size(); ++e)
        for (size_t i = 0; i + 1 < curves[e].points.size(); ++i)
            if (crosses(a, b, curves[e].points[i], curves[e].points[i + 1])) {
                inputs.push_back(graph.edges[e].to);
                break;
            }
    return inputs;
}

} // namespace kestrel::edit
