// Graphs, scenes and pictures: opened, saved, recovered.
#include "core/files.h"
#include "edit/commands.h"
#include "edit/properties.h"
#include "editor.h"
#include <algorithm>
#include <cctype>

namespace kestrel::edit {
namespace {

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return text;
}

} // namespace

// What goes with a file that was just opened; empty: a graph without one.
void Editor::takeFile(const std::filesystem::path& file) {
    if (!file.empty()) {
        watched_.read(file);
        recent_.add(file);
    }
    if (auto copy = autosave_.recover(file)) {
        session_.document.replace("Recover what was not saved", std::move(*copy));
        say("recovered what was not saved when the editor stopped; undo gives the file");
    }
}

void Editor::askToClose() {
    guard("What you changed is not saved. Close all the same?", [this] {
        autosave_.drop(session_.document.graph().file);
        done_ = true;
    });
}

void Editor::open(const std::filesystem::path& file) {
    if (file.extension() == ".json")
        guard("What you changed is not saved. Open another graph all the same?",
              [this, file] { openNow(file); });
    else if (const std::string ending = lower(file.extension().string());
             ending == ".png" || ending == ".exr" || ending == ".hdr")
        addImage(file);
    else
        session_.setScene(file.string());
}

// A picture becomes a pass that feeds it, under the pointer; named from the graph's folder, where it has one.
void Editor::addImage(const std::filesystem::path& file) {
    const std::filesystem::path folder = session_.document.graph().file.parent_path();
    std::error_code ignored;
    std::filesystem::path name = std::filesystem::absolute(file, ignored);
    if (!session_.document.graph().file.empty())
        name = std::filesystem::proximate(name, std::filesystem::absolute(folder, ignored), ignored);
    std::string pass;
    say(session_.apply("Add " + file.filename().string(), [&](Graph& graph) {
        pass = addPass(graph, session_.registry(), "Image", canvas.placeForNew());
        setProperty(graph, session_.registry(), pass, "file", name.string());
    }));
    if (session_.document.graph().find(pass) == nullptr) return;
    canvas.selection = {pass};
    canvas.picked = PortRef{pass, "image"};
}

void Editor::openNow(const std::filesystem::path& file) {
    try {
        Graph graph = loadGraph(file);
        autosave_.drop(session_.document.graph().file);
        session_.setScene("");
        session_.document.open(std::move(graph));
        session_.places.clear();
    } catch (const Error& error) {
        for (const Problem& problem : error.problems()) say(problem.text());
        return;
    }
    takeFile(file);
    canvas.selection.clear();
    viewport.pinned.clear();
    viewport.a = viewport.b = {};
    if (!session_.document.graph().outputs.empty())
        viewport.showPort(session_.document.graph().outputs.front().port);
}

void Editor::save(const std::filesystem::path& file) {
    if (file.empty()) return ask("Save as", "graph.json", [this](const std::string& typed) { save(typed); });
    try {
        writeFile(file, session_.document.text());
    } catch (const Error& error) {
        say(error.problems().front().text());
        return;
    }
    autosave_.drop(session_.document.graph().file);
    session_.document.markSaved(file);
    watched_.read(file);
    recent_.add(file);
    say("saved " + file.string());
}

} // namespace kestrel::edit
