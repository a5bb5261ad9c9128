// What the mouse does to the graph.
#include "canvas/canvas.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace kestrel::edit {

void Canvas::show(Session& session, const Theme& theme, const Say& say) {
    const ImVec2 corner = ImGui::GetCursorScreenPos(), size = ImGui::GetContentRegionAvail();
    corner_ = {corner.x, corner.y};
    size_ = glm::max(glm::dvec2(size.x, size.y), glm::dvec2(1));
    scale_ = double(theme.scale);
    layOut(session, theme);
    ImGui::InvisibleButton("canvas", {static_cast<float>(size_.x), static_cast<float>(size_.y)},
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                               ImGuiButtonFlags_MouseButtonMiddle);
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    pointer_ = glm::dvec2(mouse.x, mouse.y) - corner_;
    hovered_ = ImGui::IsItemHovered();
    handle(session, say);
    layOut(session, theme); // what was just done is seen at once
    draw(session, theme);
    tooltip(session);
}

void Canvas::layOut(Session& session, const Theme& theme) {
    const auto measure = [&](const std::string& text) {
        ImFont* font = theme.fontFor(15);
        return static_cast<double>(font->CalcTextSizeA(13, 1e6f, 0, text.c_str()).x);
    };
    if (boxesOf_ == session.document.revision() && boxes_.size() == session.document.graph().passes.size())
        return;
    // What has no place is drawn at one that the layout finds; the document stays as it is.
    // Where something is drawn it stays, whatever is changed elsewhere.
    Graph placed = session.document.graph();
    for (GraphPass& pass : placed.passes)
        if (const auto before = session.places.find(pass.name);
            !pass.position && before != session.places.end())
            pass.position = before->second;
    boxes_ = boxesOf(placed, session.registry(), measure);
    if (placeMissing(placed, sizesOf(boxes_))) boxes_ = boxesOf(placed, session.registry(), measure);
    session.places.clear();
    for (const GraphPass& pass : session.document.graph().passes)
        if (!pass.position) session.places[pass.name] = *placed.find(pass.name)->position;
    std::erase_if(selection,
                  [&](const std::string& pass) { return session.document.graph().find(pass) == nullptr; });
    if (picked && session.document.graph().find(picked->pass) == nullptr) picked.reset();
    curves_ = curvesOf(session.document.graph(), boxes_);
    boxesOf_ = session.document.revision();
}

void Canvas::attempt(Session& session, const std::string& name, const Say& say,
                     const std::function<void(Graph&)>& change, std::uint64_t gesture) {
    if (const std::string refused = session.apply(name, change, gesture); !refused.empty()) say(refused);
}

void Canvas::handle(Session& session, const Say& say) {
    const ImGuiIO& io = ImGui::GetIO();
    const auto over = [&] { return hovered_ && gesture_ == Gesture::None; };
    if (hovered_ && io.MouseWheel != 0) view.zoomAt(pointer_, std::pow(1.15, io.MouseWheel));
    if (over() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
        doubleClick(session, pointer_, say);
        return;
    }
    if (over() && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) press(session, pointer_);
    if (over() &&
        (ImGui::IsMouseClicked(ImGuiMouseButton_Middle) || ImGui::IsMouseClicked(ImGuiMouseButton_Right))) {
        gesture_ = Gesture::Pan;
        began_ = last_ = pointer_;
    }
    if (gesture_ == Gesture::None) return;
    const bool down = ImGui::IsMouseDown(ImGuiMouseButton_Left) ||
                      ImGui::IsMouseDown(ImGuiMouseButton_Middle) ||
                      ImGui::IsMouseDown(ImGuiMouseButton_Right);
    if (down)
        drag(session, pointer_, say);
    else
        release(session, pointer_, say);
}

void Canvas::press(Session& session, glm::dvec2 at) {
    const ImGuiIO& io = ImGui::GetIO();
    const Graph& graph = session.document.graph();
    held_ = hitAt(graph, boxes_, view, at, &curves_);
    began_ = last_ = at;
    moved_ = {0, 0};
    ++gestureNumber_;
    if (io.KeyAlt) {
        gesture_ = Gesture::Cut;
        return;
    }
    switch (held_.kind) {
    case Hit::Kind::Port:
        return pressPort(session, held_.port);
    case Hit::Kind::Edge: {
        // The nearer end comes along; the other stays.
        const GraphEdge& edge = *std::find_if(graph.edges.begin(), graph.edges.end(),
                                              [&](const GraphEdge& each) { return each.to == held_.port; });
        wireFrom_ = held_.nearBegin ? edge.to : edge.from;
        wireMoves_ = edge.to;
        wireCopies_ = io.KeyCtrl;
        gesture_ = Gesture::Wire;
        return;
    }
    case Hit::Kind::Bend:
        gesture_ = Gesture::Bend;
        return;
    case Hit::Kind::Pass:
        if (io.KeyShift) {
            if (!selection.erase(held_.pass)) selection.insert(held_.pass);
        } else if (!selection.contains(held_.pass)) {
            selection = {held_.pass};
        }
        gesture_ = Gesture::Move;
        return;
    case Hit::Kind::Frame:
        selection = Names(graph.frames[held_.index].passes.begin(), graph.frames[held_.index].passes.end());
        gesture_ = Gesture::Move;
        return;
    case Hit::Kind::Note:
        gesture_ = Gesture::Move;
        selection.clear();
        return;
    case Hit::Kind::Nothing:
        if (!io.KeyShift) selection.clear();
        gesture_ = Gesture::Select;
    }
}

void Canvas::pressPort(Session& session, const PortRef& port) {
    picked = port;
    selection = {port.pass};
    gesture_ = Gesture::Wire;
    wireFrom_ = port;
    wireMoves_.reset();
    wireCopies_ = ImGui::GetIO().KeyCtrl;
    // A fed input hands out the end that lies in it.
    for (const GraphEdge& edge : session.document.graph().edges)
        if (edge.to == port) {
            wireFrom_ = edge.from;
            wireMoves_ = port;
        }
}

void Canvas::drag(Session& session, glm::dvec2 at, const Say& say) {
    if (gesture_ == Gesture::Pan) view.pan(at - last_);
    if (gesture_ == Gesture::Move) {
        const glm::dvec2 whole = glm::round((at - began_) / view.zoom);
        const glm::dvec2 by = whole - moved_;
        if (by != glm::dvec2(0) && glm::length(at - began_) > 3) {
            moved_ = whole;
            const bool note = held_.kind == Hit::Kind::Note;
            attempt(
                session, note ? "Move a note" : "Move", say,
                [&](Graph& graph) {
                    if (note)
                        setNote(graph, held_.index, graph.notes.at(held_.index).text,
                                graph.notes.at(held_.index).position + by);
                    else {
                        for (GraphPass& pass : graph.passes) // moved from where it is drawn
                            if (const auto place = session.places.find(pass.name);
                                !pass.position && place != session.places.end() &&
                                selection.contains(pass.name))
                                pass.position = place->second;
                        movePasses(graph, selection, by);
                    }
                },
                gestureNumber_);
        }
    }
    if (gesture_ == Gesture::Bend)
        attempt(
            session, "Move a bend", say,
            [&](Graph& graph) {
                for (GraphEdge& edge : graph.edges)
                    if (edge.to == held_.port && held_.index < edge.bends.size())
                        edge.bends[held_.index] = glm::round(view.toCanvas(at));
            },
            gestureNumber_);
    last_ = at;
}

void Canvas::release(Session& session, glm::dvec2 at, const Say& say) {
    const Gesture gesture = gesture_;
    gesture_ = Gesture::None;
    const bool still = glm::length(at - began_) <= 3;
    switch (gesture) {
    case Gesture::Pan:
        if (still && ImGui::IsMouseReleased(ImGuiMouseButton_Right)) {
            menuHit = hitAt(session.document.graph(), boxes_, view, at, &curves_);
            wantsMenu = true;
            if (menuHit.kind == Hit::Kind::Pass && !selection.contains(menuHit.pass))
                selection = {menuHit.pass};
        }
        return;
    case Gesture::Select: {
        if (still) return;
        const Names inside = passesIn(boxes_, view.toCanvas(began_), view.toCanvas(at));
        selection.insert(inside.begin(), inside.end());
        return;
    }
    case Gesture::Move:
        if (still && held_.kind == Hit::Kind::Pass && !ImGui::GetIO().KeyShift) selection = {held_.pass};
        if (!still) {
            boxesOf_ = 0; // it lies elsewhere now
            dropOnEdge(session, say);
        }
        return;
    case Gesture::Cut: {
        const auto inputs =
            edgesAcross(session.document.graph(), boxes_, view.toCanvas(began_), view.toCanvas(at));
        if (!inputs.empty())
            attempt(session, "Cut edges", say, [&](Graph& graph) { disconnect(graph, inputs); });
        return;
    }
    case Gesture::Wire:
        if (!still) releaseWire(session, at, say);
        return;
    case Gesture::Bend:
    case Gesture::None:
        return;
    }
}

void Canvas::releaseWire(Session& session, glm::dvec2 at, const Say& say) {
    const Graph& graph = session.document.graph();
    const Registry& registry = session.registry();
    const Hit hit = hitAt(graph, boxes_, view, at, &curves_);
    std::optional<PortRef> other;
    if (hit.kind == Hit::Kind::Port) other = hit.port;
    if (hit.kind == Hit::Kind::Pass) {
        // Without the wire in hand, so that its own input counts as free.
        Graph without = graph;
        if (wireMoves_ && !wireCopies_)
            std::erase_if(without.edges, [&](const GraphEdge& edge) { return edge.to == *wireMoves_; });
        other = fittingPort(without, registry, wireFrom_, hit.pass);
        if (!other)
            return say(fmt::format("no port of '{}' fits, or several do: drop the wire on one", hit.pass));
    }
    if (!other) {
        if (wireMoves_ && !wireCopies_)
            attempt(session, "Disconnect", say, [&](Graph& next) { disconnect(next, {*wireMoves_}); });
        else
            dropped = Dropped{wireFrom_, view.toCanvas(at)};
        return;
    }
    const Box* box = boxOf(boxes_, wireFrom_.pass);
    const bool fromOutput = box != nullptr && box->find(wireFrom_) != nullptr && !box->find(wireFrom_)->input;
    attempt(session, "Connect", say, [&](Graph& next) {
        if (!wireMoves_)
            connect(next, registry, fromOutput ? wireFrom_ : *other, fromOutput ? *other : wireFrom_);
        else if (fromOutput)
            moveEdgeEnd(next, registry, *wireMoves_, *other, wireCopies_);
        else
            moveEdgeBegin(next, registry, *wireMoves_, *other);
    });
}

// One pass with no edges, dropped on a wire, goes into it.
void Canvas::dropOnEdge(Session& session, const Say& say) {
    if (selection.size() != 1) return;
    const std::string& pass = *selection.begin();
    const Graph& graph = session.document.graph();
    for (const GraphEdge& edge : graph.edges)
        if (edge.from.pass == pass || edge.to.pass == pass) return;
    const Box* box = boxOf(boxes_, pass);
    if (box == nullptr) return;
    for (const GraphEdge& edge : graph.edges)
        for (const glm::dvec2& point : curveOf(edge, boxes_))
            if (box->contains(point)) {
                attempt(
                    session, "Insert into an edge", say,
                    [&](Graph& next) { insertOnEdge(next, session.registry(), edge.to, pass); },
                    gestureNumber_);
                return;
            }
}

void Canvas::doubleClick(Session& session, glm::dvec2 at, const Say& say) {
    const Hit hit = hitAt(session.document.graph(), boxes_, view, at, &curves_);
    if (hit.kind == Hit::Kind::Pass) wantsRename = hit.pass;
    if (hit.kind == Hit::Kind::Bend)
        attempt(session, "Remove a bend", say, [&](Graph& graph) {
            for (GraphEdge& edge : graph.edges)
                if (edge.to == hit.port)
                    edge.bends.erase(edge.bends.begin() + static_cast<std::ptrdiff_t>(hit.index));
        });
    if (hit.kind == Hit::Kind::Edge)
        attempt(session, "Bend an edge", say, [&](Graph& graph) {
            for (GraphEdge& edge : graph.edges) {
                if (edge.to != hit.port) continue;
                // Between the bends that it lies between along the way.
                const glm::dvec2 point = glm::round(view.toCanvas(at));
                const auto place = std::find_if(edge.bends.begin(), edge.bends.end(),
                                                [&](const glm::dvec2& bend) { return bend.x > point.x; });
                std::vector<glm::dvec2> bends = edge.bends;
                bends.insert(bends.begin() + (place - edge.bends.begin()), point);
                setBends(graph, hit.port, std::move(bends));
                break;
            }
        });
}

void Canvas::frameAll(const Session& session) {
    if (const auto all = bounds(session.document.graph(), boxes_))
        view.show(all->first, all->second, size_, scale_);
}

void Canvas::selectAll(const Session& session) {
    for (const GraphPass& pass : session.document.graph().passes) selection.insert(pass.name);
}

void Canvas::goTo(const Session& session, const std::string& pass) {
    selection = {pass};
    (void)session;
    const Box* box = boxOf(boxes_, pass);
    if (box == nullptr) return;
    const glm::dvec2 low = view.toScreen(box->low), high = view.toScreen(box->high);
    if (low.x < 0 || low.y < 0 || high.x > size_.x || high.y > size_.y)
        view.origin = (box->low + box->high) * 0.5 - size_ * 0.5 / view.zoom;
}

glm::dvec2 Canvas::placeForNew() const {
    return glm::round(view.toCanvas(hovered_ ? pointer_ : size_ * 0.5));
}

void Canvas::step(const Session& session, glm::dvec2 direction) {
    const Box* from = selection.empty() ? nullptr : boxOf(boxes_, *selection.begin());
    const Box* best = nullptr;
    double least = 1e300;
    for (const Box& box : boxes_) {
        if (&box == from) continue;
        const glm::dvec2 way =
            (box.low + box.high) * 0.5 - (from != nullptr ? (from->low + from->high) * 0.5 : glm::dvec2(0));
        const double along = glm::dot(way, direction);
        if (from != nullptr && along <= 0) continue;
        // What lies beside the way counts as farther.
        const double cost = along + 3 * glm::length(way - along * direction);
        if (cost < least) {
            least = cost;
            best = &box;
        }
    }
    if (best != nullptr) goTo(session, std::string(best->pass));
}

} // namespace kestrel::edit
