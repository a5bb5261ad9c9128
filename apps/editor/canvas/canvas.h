// The canvas: draws the graph and turns what the mouse does into commands.
#pragma once
#include "canvas/geometry.h"
#include "edit/fits.h"
#include "session.h"
#include "ui/theme.h"
#include <functional>
#include <optional>
#include <set>
#include <string>

namespace kestrel::edit {

class Canvas {
public:
    CanvasView view;
    Names selection;
    std::optional<PortRef> picked; // the port that was clicked last: what "show" shows

    // Fills the present ImGui window. Commands that are refused are told through `say`.
    void show(Session& session, const Theme& theme, const std::function<void(const std::string&)>& say);

    // ---- what menus and keys do, too
    void frameAll(const Session& session);
    void zoomBy(double factor) { view.zoomAt(size_ * 0.5, factor); } // about the middle
    void selectAll(const Session& session);
    // Selects a pass and brings it into view.
    void goTo(const Session& session, const std::string& pass);
    // The place for something new: under the pointer if it is over the canvas, else the middle.
    [[nodiscard]] glm::dvec2 placeForNew() const;
    // Selects what lies left or right along an edge, above or below: from the first of the selection.
    void step(const Session& session, glm::dvec2 direction);

    // A wire that was dropped in the empty: which port it comes from, and where it fell. The editor opens its
    // list of offers and resets it.
    struct Dropped {
        PortRef port;
        glm::dvec2 place;
    };
    std::optional<Dropped> dropped;
    std::optional<std::string> wantsRename; // double click on a box
    bool wantsMenu = false;                 // right click without a drag; `menuHit` says on what
    Hit menuHit;

    // Boxes of the last frame, screen coordinates of the canvas's left upper corner: for tests.
    [[nodiscard]] const std::vector<Box>& boxes() const { return boxes_; }
    [[nodiscard]] glm::dvec2 corner() const { return corner_; }

private:
    enum class Gesture { None, Pan, Move, Select, Wire, Cut, Bend };
    using Say = std::function<void(const std::string&)>;

    void layOut(Session& session, const Theme& theme);
    void handle(Session& session, const Say& say);
    void press(Session& session, glm::dvec2 at);
    void pressPort(Session& session, const PortRef& port);
    void drag(Session& session, glm::dvec2 at, const Say& say);
    void release(Session& session, glm::dvec2 at, const Say& say);
    void releaseWire(Session& session, glm::dvec2 at, const Say& say);
    void dropOnEdge(Session& session, const Say& say);
    void doubleClick(Session& session, glm::dvec2 at, const Say& say);
    static void attempt(Session& session, const std::string& name, const Say& say,
                        const std::function<void(Graph&)>& change, std::uint64_t gesture = 0);

    void draw(const Session& session, const Theme& theme);
    void drawFrames(const Session& session, const Theme& theme);
    void drawEdges(const Session& session, const Theme& theme);
    void drawBox(const Session& session, const Theme& theme, const GraphPass& pass, const Box& box);
    void drawGesture(const Theme& theme);
    void drawText(const Theme& theme, glm::dvec2 canvas, double size, ImU32 colour, const std::string& text,
                  bool right = false) const;
    void tooltip(const Session& session);
    [[nodiscard]] ImVec2 screen(glm::dvec2 canvas) const;

    std::vector<Box> boxes_;
    Curves curves_;                            // of the edges
    double scale_ = 1;                         // of the theme: the closest that all is shown
    std::set<std::string, std::less<>> faded_; // passes that are left out of the present plan
    std::uint64_t boxesOf_ = 0;                // revision of the document that they are of
    glm::dvec2 corner_{0}, size_{0}, pointer_{0};
    bool hovered_ = false;

    Gesture gesture_ = Gesture::None;
    std::uint64_t gestureNumber_ = 0; // of undo: one step a drag
    glm::dvec2 began_{0}, last_{0};   // screen
    glm::dvec2 moved_{0};             // canvas, in whole units, of a move
    Hit held_;
    PortRef wireFrom_;                 // the fixed end of the wire
    std::optional<PortRef> wireMoves_; // the input of an edge whose end is in hand
    bool wireCopies_ = false;
};

} // namespace kestrel::edit
