// What the editor does by key, menu and palette.
#include "blame.h"
#include "core/files.h"
#include "edit/commands.h"
#include "editor.h"
#include "measure/run_stats.h"
#include <algorithm>
#include <fmt/format.h>
#include <imgui.h>

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
        ask_ = Ask::SaveAs;
        askFresh_ = true;
        typed_ = session_.document.graph().file.string();
    });
    add("Copy the command line", "Ctrl+Shift+C", [this] {
        const std::string line = session_.commandLine(viewport.a);
        ImGui::SetClipboardText(line.c_str());
        say("copied: " + line);
    });
    add("Write stats.json", "", [this] {
        if (session_.renderer() == nullptr || session_.frames() == 0) return;
        RunStats stats = gatherStats(*session_.renderer(), session_.profile(), session_.driver());
        stats.graphPath = session_.document.graph().file.string();
        writeFile("stats.json", statsJson(stats));
        say("wrote stats.json");
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
            ask_ = Ask::Frame;
            askFresh_ = true;
            typed_.clear();
        },
        selected);
    add("Note...", "N", [this] {
        ask_ = Ask::Note;
        askFresh_ = true;
        typed_.clear();
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
        "Make the port an output, or none", "O",
        [this] {
            const PortRef port = *canvas.picked;
            const auto& outputs = session_.document.graph().outputs;
            const bool is = std::any_of(outputs.begin(), outputs.end(),
                                        [&](const GraphOutput& output) { return output.port == port; });
            say(session_.apply(is ? "No output" : "Output",
                               [&](Graph& graph) { setOutput(graph, session_.registry(), port, !is); }));
        },
        [this] { return canvas.picked.has_value(); });
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
    add("Play or pause", "Space", [this] { session_.playing = !session_.playing; });
    add("Next frame", ".", [this] {
        session_.playing = false;
        session_.render();
    });
    add("From the first frame", "Home", [this] {
        session_.restart();
        framesAtChange_ = session_.frames();
    });
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

} // namespace kestrel::edit
