// What the editor does by key, menu and palette.
#include "blame.h"
#include "edit/commands.h"
#include "editor.h"
#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <imgui.h>
#include <iterator>

namespace kestrel::edit {
namespace {

Chord key(const char* text) { return chordOf(text); }

} // namespace

void Editor::addFileActions() {
    const auto add = [&](const char* name, const char* chord, std::function<void()> run) {
        actions_.add({.menu = "File", .name = name, .key = key(chord), .run = std::move(run)});
    };
    add("New", "Ctrl+N", [this] {
        guard("What you changed is not saved. Begin a new graph all the same?", [this] {
            autosave_.drop(session_.document.graph().file);
            Graph graph;
            graph.sceneSource = session_.document.graph().sceneSource;
            session_.document.open(std::move(graph));
            session_.places.clear();
            viewport.a = viewport.b = {};
        });
    });
    add("Open...", "Ctrl+O", [this] { browse({}); });
    add("Save", "Ctrl+S", [this] { save(session_.document.graph().file); });
    add("Save as...", "Ctrl+Shift+S", [this] {
        ask("Save as", session_.document.graph().file.string(),
            [this](const std::string& typed) { save(typed); });
    });
    add("Quit", "Ctrl+Q", [this] { askToClose(); });
}

void Editor::addEditActions() {
    const auto add = [&](const char* name, const char* chord, std::function<void()> run,
                         std::function<bool()> enabled = {}, std::function<std::string()> detail = {}) {
        actions_.add({.menu = "Edit",
                      .name = name,
                      .key = key(chord),
                      .run = std::move(run),
                      .enabled = std::move(enabled),
                      .detail = std::move(detail)});
    };
    const auto selected = [this] { return !canvas.selection.empty(); };
    const auto edit = [this](const char* name, auto change) {
        return [this, name, change] { say(session_.apply(name, [&](Graph& graph) { change(graph); })); };
    };
    Document& document = session_.document;
    add(
        "Undo", "Ctrl+Z", [&document] { document.undo(); },
        [&document] { return !document.undoName().empty(); }, [&document] { return document.undoName(); });
    add(
        "Redo", "Ctrl+Y", [&document] { document.redo(); },
        [&document] { return !document.redoName().empty(); }, [&document] { return document.redoName(); });
    add(
        "Cut", "Ctrl+X",
        [this] {
            copy(false);
            say(session_.apply("Cut", [&](Graph& graph) {
                removePasses(graph, session_.registry(), canvas.selection, false);
            }));
        },
        selected);
    add(
        "Copy", "Ctrl+C", [this] { copy(false); }, selected);
    add(
        "Copy with inputs", "Ctrl+Alt+C", [this] { copy(true); }, selected);
    add("Paste", "Ctrl+V", [this] { paste(); });
    add(
        "Duplicate", "Ctrl+D",
        [this] {
            Names copies;
            say(session_.apply("Duplicate", [&](Graph& graph) {
                keepPlaces(graph, session_.places);
                const auto made = duplicatePasses(graph, canvas.selection, true, {30, 30});
                copies.insert(made.begin(), made.end());
            }));
            if (!copies.empty()) canvas.selection = copies;
        },
        selected);
    add("Delete", "Del",
        edit("Delete",
             [this](Graph& graph) { removePasses(graph, session_.registry(), canvas.selection, false); }),
        selected);
    add("Delete and reconnect", "Shift+Del",
        edit("Delete and reconnect",
             [this](Graph& graph) { removePasses(graph, session_.registry(), canvas.selection, true); }),
        selected);
    add("Select all", "Ctrl+A", [this] { canvas.selectAll(session_); });
    add(
        "Arrange the selection", "L",
        [this] {
            const Sizes sizes = sizesOf(canvas.boxes());
            say(session_.apply("Arrange", [&](Graph& graph) {
                for (GraphPass& pass : graph.passes)
                    if (const auto place = session_.places.find(pass.name); place != session_.places.end())
                        pass.position = place->second;
                arrange(graph, canvas.selection, sizes);
            }));
        },
        selected);
    add(
        "Frame around the selection...", "Ctrl+G",
        [this] {
            ask("Title", "", [this](const std::string& typed) {
                say(session_.apply("Frame", [&](Graph& graph) { addFrame(graph, typed, canvas.selection); }));
            });
        },
        selected);
    add("Note...", "N", [this] {
        ask("Note", "", [this](const std::string& typed) {
            say(session_.apply("Note", [&](Graph& graph) { addNote(graph, typed, canvas.placeForNew()); }));
        });
    });
}

void Editor::addPassActions() {
    const auto add = [&](const char* name, const char* chord, std::function<void()> run,
                         std::function<bool()> enabled = {}) {
        actions_.add({.menu = "Pass",
                      .name = name,
                      .key = key(chord),
                      .run = std::move(run),
                      .enabled = std::move(enabled)});
    };
    const auto one = [this] { return !selectedPass().empty(); };
    const auto some = [this] { return !canvas.selection.empty(); };
    add("Add...", "A", [this] { addPassByName(std::nullopt); });
    add("Find...", "Ctrl+F", [this] { findPass(); });
    add(
        "Swap...", "W", [this] { swap(); }, one);
    add(
        "Rename...", "F2", [this] { rename(); }, one);
    add(
        "Mute", "M",
        [this] {
            const Graph& graph = session_.document.graph();
            const bool mute = std::any_of(canvas.selection.begin(), canvas.selection.end(),
                                          [&](const std::string& pass) { return !graph.find(pass)->muted; });
            say(session_.apply(mute ? "Mute" : "Unmute",
                               [&](Graph& next) { setMuted(next, canvas.selection, mute); }));
        },
        some);
    add(
        "Show a port", "V", [this] { showPort(); },
        [this] { return canvas.picked || !selectedPass().empty(); });
    add("Pin the port that is shown", "P", [this] {
        auto& pinned = viewport.pinned;
        const auto found = std::find(pinned.begin(), pinned.end(), viewport.a);
        if (found == pinned.end() && !viewport.a.pass.empty())
            pinned.push_back(viewport.a);
        else if (found != pinned.end())
            pinned.erase(found);
    });
    add(
        "Make a port an output, or none", "O", [this] { toggleOutput(); },
        [this] { return canvas.picked || !selectedPass().empty(); });
    add(
        "Connect...", "K", [this] { connectByName(); }, one);
    add(
        "Disconnect...", "Shift+K", [this] { disconnectByName(); }, some);
    add(
        "Edit the properties", "Enter", [this] { properties_.focus = true; }, one);
}

void Editor::addViewActions() {
    const auto add = [&](const char* name, const char* chord, std::function<void()> run) {
        actions_.add({.menu = "View", .name = name, .key = key(chord), .run = std::move(run)});
    };
    add("Everything by name...", "Ctrl+P", [this] { openPalette(); });
    add("Frame all", "F", [this] { canvas.frameAll(session_); });
    add("Left", "Left", [this] { canvas.step(session_, {-1, 0}); });
    add("Right", "Right", [this] { canvas.step(session_, {1, 0}); });
    add("Up", "Up", [this] { canvas.step(session_, {0, -1}); });
    add("Down", "Down", [this] { canvas.step(session_, {0, 1}); });
    add("Nearer to the canvas", "=", [this] { canvas.zoomBy(1.25); });
    add("Farther from the canvas", "-", [this] { canvas.zoomBy(0.8); });
    add("Move the selection left", "Ctrl+Shift+Left", [this] { nudge({-20, 0}); });
    add("Move the selection right", "Ctrl+Shift+Right", [this] { nudge({20, 0}); });
    add("Move the selection up", "Ctrl+Shift+Up", [this] { nudge({0, -20}); });
    add("Move the selection down", "Ctrl+Shift+Down", [this] { nudge({0, 20}); });
    add("Hold the picture and compare", "H", [this] {
        if (viewport.holds()) {
            viewport.letGo();
            viewport.layout = Viewport::Layout::One;
        } else {
            viewport.hold();
        }
    });
    add("One picture, split, slider", "Tab", [this] {
        viewport.layout = static_cast<Viewport::Layout>((static_cast<int>(viewport.layout) + 1) % 3);
    });
    add("Slider to the left", "[", [this] { viewport.slider = std::max(viewport.slider - 0.05f, 0.0f); });
    add("Slider to the right", "]", [this] { viewport.slider = std::min(viewport.slider + 0.05f, 1.0f); });
    add("Colour, code values, one channel, heat map", "D", [this] {
        auto& mode = viewport.development.mode;
        mode = static_cast<Development::Mode>((static_cast<int>(mode) + 1) %
                                              static_cast<int>(std::size(developmentNames)));
    });
    add("Size of the picture's pixels", "Z", [this] {
        viewport.zoom = viewport.zoom == 0 ? 1 : viewport.zoom >= 8 ? 0 : 2 * viewport.zoom;
    });
    add("Values of a pixel...", "I", [this] { askPixel(); });
    add("Where did this pixel go wrong?", "B", [this] {
        const auto pixel = viewport.pixel();
        if (!pixel) return say("point at a pixel of the picture first");
        const auto found = blame(session_, viewport.a, pixel->first, pixel->second);
        if (!found) return say(fmt::format("the pixel {}, {} is right", pixel->first, pixel->second));
        say(fmt::format("{} first in {} at {}, {}: {}", faultName(found->fault), found->port.text(), found->x,
                        found->y, found->why));
        canvas.goTo(session_, found->port.pass);
        canvas.picked = found->port;
    });
    add("Automatic range", "R", [this] { viewport.automatic = !viewport.automatic; });
    add("Brighter", "Shift+Up", [this] { viewport.development.exposure += 0.5f; });
    add("Darker", "Shift+Down", [this] { viewport.development.exposure -= 0.5f; });
    add("Dark or light", "F8", [this] {
        theme_.dark = !theme_.dark;
        themeChanged_ = true;
    });
    add("Larger text", "Ctrl+=", [this] {
        theme_.scale = std::min(theme_.scale * 1.25f, 3.0f);
        themeChanged_ = true;
    });
    add("Smaller text", "Ctrl+-", [this] {
        theme_.scale = std::max(theme_.scale / 1.25f, 0.6f);
        themeChanged_ = true;
    });
    add("Shortcuts", "F1", [this] { shortcuts_ = !shortcuts_; });
}

void Editor::askPixel() {
    ask("Pixel: x y, from the left upper corner", "", [this](const std::string& typed) {
        int x = -1, y = -1;
        const Image& image = viewport.image();
        if (std::sscanf(typed.c_str(), "%d %d", &x, &y) != 2 || x < 0 || y < 0 || x >= image.width ||
            y >= image.height)
            return say(fmt::format("a pixel of a picture of {} is two numbers", image.sizeText()));
        viewport.setPixel(x, y);
    });
}

void Editor::nudge(glm::dvec2 by) {
    if (canvas.selection.empty()) return;
    say(session_.apply("Move", [&](Graph& graph) {
        keepPlaces(graph, session_.places);
        movePasses(graph, canvas.selection, by);
    }));
}

} // namespace kestrel::edit
