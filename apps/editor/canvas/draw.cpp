// How the canvas looks.
#include "canvas/canvas.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace kestrel::edit {

ImVec2 Canvas::screen(glm::dvec2 canvas) const {
    const glm::dvec2 at = view.toScreen(canvas) + corner_;
    return {static_cast<float>(at.x), static_cast<float>(at.y)};
}

void Canvas::drawText(const Theme& theme, glm::dvec2 canvas, double size, ImU32 colour,
                      const std::string& text, bool right) const {
    const auto pixels = static_cast<float>(size * view.zoom);
    if (pixels < 4) return; // nobody reads it
    ImFont* font = theme.fontFor(pixels);
    ImVec2 at = screen(canvas);
    if (right) at.x -= font->CalcTextSizeA(pixels, 1e6f, 0, text.c_str()).x;
    ImGui::GetWindowDrawList()->AddText(font, pixels, at, colour, text.c_str());
}

void Canvas::draw(const Session& session, const Theme& theme) {
    faded_.clear();
    if (session.renderer() != nullptr)
        for (const LeftOut& item : session.renderer()->plan().leftOut) faded_.insert(item.what);
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 low(static_cast<float>(corner_.x), static_cast<float>(corner_.y));
    const ImVec2 high(static_cast<float>(corner_.x + size_.x), static_cast<float>(corner_.y + size_.y));
    list->PushClipRect(low, high, true);
    list->AddRectFilled(low, high, theme.canvas());
    // A grid whose lines stay 50 to 500 pixels apart.
    double step = 100;
    while (step * view.zoom < 50) step *= 5;
    for (double x = std::floor(view.origin.x / step) * step; view.toScreen({x, 0}).x < size_.x; x += step)
        list->AddLine({screen({x, 0}).x, low.y}, {screen({x, 0}).x, high.y}, theme.grid());
    for (double y = std::floor(view.origin.y / step) * step; view.toScreen({0, y}).y < size_.y; y += step)
        list->AddLine({low.x, screen({0, y}).y}, {high.x, screen({0, y}).y}, theme.grid());
    drawFrames(session, theme);
    drawEdges(session, theme);
    const Graph& graph = session.document.graph();
    for (size_t i = 0; i < graph.passes.size(); ++i) {
        const ImVec2 a = screen(boxes_[i].low), b = screen(boxes_[i].high);
        if (b.x >= low.x && a.x <= high.x && b.y >= low.y && a.y <= high.y)
            drawBox(session, theme, graph.passes[i], boxes_[i]);
    }
    drawGesture(theme);
    list->PopClipRect();
}

void Canvas::drawFrames(const Session& session, const Theme& theme) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const Graph& graph = session.document.graph();
    const auto rounding = static_cast<float>(8 * view.zoom);
    for (const GraphFrame& frame : graph.frames)
        if (const auto box = frameBox(frame, boxes_)) {
            list->AddRectFilled(screen(box->low), screen(box->high), theme.frame(), rounding);
            drawText(theme, box->low + glm::dvec2(8, 4), 15, theme.text(), frame.title);
        }
    for (const GraphNote& note : graph.notes) {
        list->AddRectFilled(screen(note.position), screen(note.position + glm::dvec2(200, 60)), theme.note(),
                            rounding);
        drawText(theme, note.position + glm::dvec2(8, 6), 13, theme.text(), note.text);
    }
}

void Canvas::drawEdges(const Session& session, const Theme& theme) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const auto wrong = [&](const PortRef& input) {
        return std::any_of(session.problems().begin(), session.problems().end(),
                           [&](const Marked& marked) { return marked.input == input; });
    };
    const ImVec2 low = list->GetClipRectMin(), high = list->GetClipRectMax();
    const std::vector<GraphEdge>& edges = session.document.graph().edges;
    std::vector<ImVec2> points;
    for (size_t i = 0; i < edges.size(); ++i) {
        const GraphEdge& edge = edges[i];
        points.clear();
        ImVec2 least(1e9f, 1e9f), most(-1e9f, -1e9f);
        for (const glm::dvec2& point : curves_[i].points) {
            points.push_back(screen(point));
            least = {std::min(least.x, points.back().x), std::min(least.y, points.back().y)};
            most = {std::max(most.x, points.back().x), std::max(most.y, points.back().y)};
        }
        if (points.empty() || most.x < low.x || least.x > high.x || most.y < low.y || least.y > high.y)
            continue;
        const bool faded = faded_.contains(edge.to.pass) || faded_.contains(edge.from.pass);
        const ImU32 colour = wrong(edge.to) ? Theme::mistake() : Theme::port(curves_[i].kind, faded);
        const bool chosen = selection.contains(edge.from.pass) || selection.contains(edge.to.pass);
        const float width = std::max(1.0f, static_cast<float>((chosen ? 3.0 : 2.0) * view.zoom));
        list->AddPolyline(points.data(), static_cast<int>(points.size()), colour, 0, width);
        for (const glm::dvec2& bend : edge.bends)
            list->AddCircleFilled(screen(bend), std::max(3.0f, 2 * width), colour);
    }
    (void)theme;
}

void Canvas::drawBox(const Session& session, const Theme& theme, const GraphPass& pass, const Box& box) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const bool faded = faded_.contains(pass.name);
    const bool wrong =
        std::any_of(session.problems().begin(), session.problems().end(),
                    [&](const Marked& marked) { return marked.pass == pass.name && !marked.input; });
    const ImVec2 low = screen(box.low), high = screen(box.high);
    const auto rounding = static_cast<float>(5 * view.zoom);
    list->AddRectFilled(low, high, theme.box(), rounding);
    const bool selected = selection.contains(pass.name);
    list->AddRect(low, high, wrong ? Theme::mistake() : theme.outline(selected), rounding, 0,
                  wrong || selected ? 2.5f : 1.0f);
    drawText(theme, box.low + glm::dvec2(look::margin, 4), 15, theme.text(faded), pass.name);
    drawText(theme, box.low + glm::dvec2(look::margin, 22), 11, theme.text(true), pass.type);
    for (const PortPlace& place : box.ports) {
        const ImVec2 at = screen(place.at);
        const auto radius = std::max(2.5f, static_cast<float>(look::portRadius * view.zoom));
        const ImU32 colour = Theme::port(place.kind, faded);
        // Modules are diamonds, so that the kinds do not differ by colour alone; what may stay free is
        // hollow.
        if (isModule(place.kind)) {
            const ImVec2 corners[] = {{at.x, at.y - 1.3f * radius},
                                      {at.x + 1.3f * radius, at.y},
                                      {at.x, at.y + 1.3f * radius},
                                      {at.x - 1.3f * radius, at.y}};
            if (place.optional)
                list->AddPolyline(corners, 4, colour, ImDrawFlags_Closed, 1.5f);
            else
                list->AddConvexPolyFilled(corners, 4, colour);
        } else if (place.optional) {
            list->AddCircle(at, radius, colour, 0, 1.5f);
        } else {
            list->AddCircleFilled(at, radius, colour);
        }
        const double inward = place.input ? 9 : -9;
        drawText(theme, place.at + glm::dvec2(inward, -7), 12, theme.text(faded), place.port.port,
                 !place.input);
        if (picked == place.port) list->AddCircle(at, radius + 3, theme.outline(true), 0, 1.5f);
    }
    if (pass.muted) list->AddLine({low.x, high.y}, {high.x, low.y}, theme.text(true), 2);
}

void Canvas::drawGesture(const Theme& theme) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const auto toImGui = [&](glm::dvec2 at) {
        return ImVec2(static_cast<float>(at.x + corner_.x), static_cast<float>(at.y + corner_.y));
    };
    if (gesture_ == Gesture::Select) {
        list->AddRect(toImGui(began_), toImGui(last_), theme.outline(true));
    } else if (gesture_ == Gesture::Cut) {
        list->AddLine(toImGui(began_), toImGui(last_), Theme::mistake(), 2);
    } else if (gesture_ == Gesture::Wire) {
        const Box* box = boxOf(boxes_, wireFrom_.pass);
        const PortPlace* place = box != nullptr ? box->find(wireFrom_) : nullptr;
        if (place == nullptr) return;
        const glm::dvec2 end = view.toCanvas(last_);
        std::vector<ImVec2> points;
        for (const glm::dvec2& point :
             place->input ? curveBetween(end, place->at) : curveBetween(place->at, end))
            points.push_back(screen(point));
        list->AddPolyline(points.data(), static_cast<int>(points.size()), Theme::port(place->kind), 0, 2);
    }
}

// Why something is faded or wrong, what a port is.
void Canvas::tooltip(const Session& session) {
    if (!hovered_ || gesture_ != Gesture::None) return;
    const Graph& graph = session.document.graph();
    const Hit hit = hitAt(graph, boxes_, view, pointer_, &curves_);
    std::string text;
    const auto add = [&](const std::string& line) { text += (text.empty() ? "" : "\n") + line; };
    const GraphPass* pass = graph.find(hit.kind == Hit::Kind::Edge ? hit.port.pass : hit.pass);
    if (pass == nullptr) return;
    const PassType* type = session.registry().find(pass->type);
    if (hit.kind == Hit::Kind::Port) {
        const PortInfo* port = type != nullptr ? type->port(hit.port.port) : nullptr;
        if (port != nullptr)
            add(fmt::format("{}: {}{}\n{}", port->name, portKindName(port->kind),
                            port->optional ? ", optional" : "", port->description));
        if (port != nullptr && !describe(port->content).empty()) add(describe(port->content));
    } else if (hit.kind == Hit::Kind::Pass) {
        if (type != nullptr) add(type->description);
        if (!pass->comment.empty()) add(pass->comment);
        if (const std::string why = session.leftOut(pass->name); !why.empty()) add("left out: " + why);
    }
    for (const Marked& marked : session.problems())
        if ((marked.pass == pass->name && !marked.input && hit.kind == Hit::Kind::Pass) ||
            (marked.input && *marked.input == hit.port))
            add("wrong: " + marked.message);
    if (!text.empty()) ImGui::SetTooltip("%s", text.c_str());
}

} // namespace kestrel::edit
