// Lists that narrow while one types: what to add, swap, show, open.
#include "core/files.h"
#include "edit/clipboard.h"
#include "edit/commands.h"
#include "edit/search.h"
#include "editor.h"
#include <algorithm>
#include <fmt/format.h>
#include <imgui.h>

namespace kestrel::edit {

void Editor::openPalette() {
    std::vector<Palette::Entry> entries;
    for (const Action& action : actions_.all())
        if (action.can()) entries.push_back({action.title(), chordText(action.key), action.run});
    for (const GraphPass& pass : session_.document.graph().passes)
        entries.push_back(
            {"Go to " + pass.name, pass.type, [this, name = pass.name] { canvas.goTo(session_, name); }});
    palette_.open("Anything", std::move(entries));
}

void Editor::findPass() {
    std::vector<Palette::Entry> entries;
    const Graph& graph = session_.document.graph();
    for (const GraphPass& pass : graph.passes) {
        // All that one may remember of a pass is in its line; letters narrow it.
        std::string detail = pass.type;
        for (const GraphEdge& edge : graph.edges) {
            if (edge.to.pass == pass.name) detail += " reads " + edge.from.text();
            if (edge.from.pass == pass.name) detail += " writes " + edge.to.text();
        }
        entries.push_back({pass.name, detail, [this, name = pass.name] { canvas.goTo(session_, name); }});
    }
    palette_.open("Find a pass", std::move(entries), [this](const std::string& typed) {
        std::vector<std::string> names;
        for (const Found& found : search(session_.document.graph(), session_.registry(), typed))
            names.push_back(found.pass);
        return names;
    });
}

void Editor::addPassByName(std::optional<Canvas::Dropped> joined) {
    std::vector<Palette::Entry> entries;
    const auto entry = [&](const std::string& title, const std::string& detail,
                           std::function<std::string(Graph&)> make) {
        entries.push_back({title, detail, [this, title, make = std::move(make)] {
                               std::string name;
                               say(session_.apply("Add " + title, [&](Graph& graph) { name = make(graph); }));
                               if (session_.document.graph().find(name) != nullptr) canvas.selection = {name};
                           }});
    };
    const Registry& registry = session_.registry();
    if (joined) {
        for (const Offer& offer : offersFor(session_.document.graph(), registry, joined->port))
            entry(offer.type, "by " + offer.port + ": " + offer.description,
                  [this, offer, at = *joined](Graph& graph) {
                      return addJoined(graph, session_.registry(), at.port, offer, glm::round(at.place));
                  });
        palette_.open("What fits " + joined->port.text(), std::move(entries));
        return;
    }
    for (const PassType& type : registry.types())
        entry(type.name, type.description, [this, name = type.name](Graph& graph) {
            return addPass(graph, session_.registry(), name, canvas.placeForNew());
        });
    palette_.open("Add a pass", std::move(entries));
}

void Editor::swap() {
    const std::string pass = selectedPass();
    const Graph& graph = session_.document.graph();
    std::vector<Palette::Entry> entries;
    const auto tell = [this](const Swapped& swapped) {
        say(fmt::format("edges that stay: {}", swapped.kept.size()));
        for (const std::string& dropped : swapped.dropped) say("dropped: " + dropped);
    };
    for (const std::string& rival : rivalPasses(graph, session_.registry(), pass))
        entries.push_back(
            {rival, "takes the place of " + pass + ": " + graph.find(rival)->type, [this, pass, rival, tell] {
                 Swapped swapped;
                 const std::string refused =
                     session_.apply(fmt::format("{} in place of {}", rival, pass), [&](Graph& next) {
                         swapped = useInstead(next, session_.registry(), pass, rival);
                     });
                 say(refused);
                 if (refused.empty()) {
                     tell(swapped);
                     canvas.selection = {rival};
                 }
             }});
    for (const std::string& type : rivalTypes(graph, session_.registry(), pass))
        entries.push_back({type, pass + " becomes a " + type, [this, pass, type, tell] {
                               Swapped swapped;
                               const std::string refused =
                                   session_.apply(fmt::format("{} becomes {}", pass, type), [&](Graph& next) {
                                       swapped = swapType(next, session_.registry(), pass, type);
                                   });
                               say(refused);
                               if (refused.empty()) tell(swapped);
                           }});
    palette_.open("In the place of " + pass, std::move(entries));
}

// The port that was picked, else one of the selected pass's by name.
void Editor::withPort(const std::string& prompt, const std::function<void(const PortRef&)>& then) {
    if (canvas.picked && (canvas.selection.empty() || canvas.selection.contains(canvas.picked->pass)))
        return then(*canvas.picked);
    const GraphPass* pass = session_.document.graph().find(selectedPass());
    const PassType* type = pass != nullptr ? session_.registry().find(pass->type) : nullptr;
    if (type == nullptr) return;
    std::vector<Palette::Entry> entries;
    for (const PortInfo& port : type->ports)
        if (!isModule(port.kind))
            entries.push_back(
                {port.name, port.description, [then, ref = PortRef{pass->name, port.name}] { then(ref); }});
    palette_.open(prompt + " of " + pass->name, std::move(entries));
}

void Editor::showPort() {
    withPort("Show which port", [this](const PortRef& port) { viewport.showPort(port); });
}

void Editor::toggleOutput() {
    withPort("Which output", [this](const PortRef& port) {
        const auto& outputs = session_.document.graph().outputs;
        const bool is = std::any_of(outputs.begin(), outputs.end(),
                                    [&](const GraphOutput& output) { return output.port == port; });
        say(session_.apply(is ? "No output" : "Output",
                           [&](Graph& graph) { setOutput(graph, session_.registry(), port, !is); }));
    });
}

// Every wire that could lead into the selected pass or out of it.
void Editor::connectByName() {
    const Graph& graph = session_.document.graph();
    const GraphPass* pass = graph.find(selectedPass());
    const PassType* type = pass != nullptr ? session_.registry().find(pass->type) : nullptr;
    if (type == nullptr) return;
    std::vector<Palette::Entry> entries;
    const auto offer = [&](const PortRef& from, const PortRef& to, const std::string& detail) {
        const bool there = std::any_of(graph.edges.begin(), graph.edges.end(), [&](const GraphEdge& edge) {
            return edge.from == from && edge.to == to;
        });
        if (there || !whyNot(graph, session_.registry(), from, to).empty()) return;
        entries.push_back({from.text() + " -> " + to.text(), detail, [this, from, to] {
                               say(session_.apply("Connect", [&](Graph& next) {
                                   connect(next, session_.registry(), from, to);
                               }));
                           }});
    };
    for (const PortInfo& port : type->ports)
        for (const GraphPass& other : graph.passes) {
            const PassType* otherType = session_.registry().find(other.type);
            if (&other == pass || otherType == nullptr || port.direction == PortDirection::Internal) continue;
            const PortRef own{pass->name, port.name};
            for (const PortInfo& end : otherType->ports) {
                if (end.kind != port.kind || end.direction == PortDirection::Internal) continue;
                if (port.direction == PortDirection::Input && end.direction == PortDirection::Output)
                    offer({other.name, end.name}, own, port.description);
                if (port.direction == PortDirection::Output && end.direction == PortDirection::Input)
                    offer(own, {other.name, end.name}, end.description);
            }
        }
    palette_.open("Connect", std::move(entries));
}

void Editor::disconnectByName() {
    std::vector<Palette::Entry> entries;
    for (const GraphEdge& edge : session_.document.graph().edges)
        if (canvas.selection.contains(edge.from.pass) || canvas.selection.contains(edge.to.pass))
            entries.push_back(
                {edge.from.text() + " -> " + edge.to.text(), "", [this, to = edge.to] {
                     say(session_.apply("Disconnect", [&](Graph& graph) { disconnect(graph, {to}); }));
                 }});
    palette_.open("Disconnect", std::move(entries));
}

void Editor::browse(const std::filesystem::path& folder) {
    std::vector<Palette::Entry> entries;
    std::error_code ignored;
    if (folder.empty()) {
        for (const std::filesystem::path& file : recent_.graphs())
            entries.push_back(
                {file.filename().string(), "recent: " + file.string(), [this, file] { open(file); }});
        for (const auto& each : std::filesystem::directory_iterator(shareFolder() / "graphs", ignored))
            if (each.path().extension() == ".json" && each.path().filename() != "schema.json")
                entries.push_back({each.path().filename().string(), "comes with Kestrel",
                                   [this, file = each.path()] { open(file); }});
    }
    const std::filesystem::path here = folder.empty() ? std::filesystem::current_path() : folder;
    entries.push_back({"..", here.parent_path().string(), [this, up = here.parent_path()] { browse(up); }});
    for (const auto& each : std::filesystem::directory_iterator(here, ignored)) {
        const std::string extension = each.path().extension().string();
        if (each.is_directory(ignored))
            entries.push_back({each.path().filename().string() + "/", here.string(),
                               [this, file = each.path()] { browse(file); }});
        else if (extension == ".json" || extension == ".glb" || extension == ".gltf" || extension == ".png" ||
                 extension == ".exr" || extension == ".hdr")
            entries.push_back(
                {each.path().filename().string(), here.string(), [this, file = each.path()] { open(file); }});
    }
    palette_.open("Open a graph, a scene or a picture", std::move(entries));
}

// ---- clipboard, names

void Editor::copy(bool keepInputs) {
    ImGui::SetClipboardText(copyText(session_.document.graph(), canvas.selection, keepInputs).c_str());
}

void Editor::paste() {
    const char* text = ImGui::GetClipboardText();
    if (text == nullptr || *text == 0) return say("the clipboard holds no text");
    Pasted pasted;
    say(session_.apply("Paste", [&](Graph& graph) {
        pasted = pasteText(graph, session_.registry(), text, canvas.placeForNew());
    }));
    for (const std::string& remark : pasted.remarks) say(remark);
    if (!pasted.passes.empty()) canvas.selection = Names(pasted.passes.begin(), pasted.passes.end());
}

void Editor::rename() {
    const std::string pass = selectedPass();
    ask("Name", pass, [this, pass](const std::string& typed) {
        say(session_.apply("Rename " + pass, [&](Graph& graph) { renamePass(graph, pass, typed); }));
        if (session_.document.graph().find(typed) != nullptr) canvas.selection = {typed};
    });
}

} // namespace kestrel::edit
