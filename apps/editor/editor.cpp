#include "editor.h"
#include "core/files.h"
#include "edit/commands.h"
#include <algorithm>
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

namespace kestrel::edit {

Editor::Editor(Session& session, Theme& theme, std::filesystem::path state)
    : session_(session)
    , theme_(theme)
    , autosave_(state / "autosave")
    , recent_(state / "recent.txt") {
    addFileActions();
    addEditActions();
    addPassActions();
    addViewActions();
    const Graph& graph = session_.document.graph();
    if (!graph.outputs.empty()) viewport.showPort(graph.outputs.front().port);
    if (!graph.file.empty()) {
        watched_.read(graph.file);
        recent_.add(graph.file);
        if (auto copy = autosave_.recover(graph.file)) {
            session_.document.replace("Recover what was not saved", std::move(*copy));
            say("recovered what was not saved when the editor stopped; undo gives the file");
        }
    }
}

void Editor::say(const std::string& message) {
    if (message.empty()) return;
    messages_.push_back(message);
    if (messages_.size() > 100) messages_.pop_front();
}

std::string Editor::title() const {
    const Graph& graph = session_.document.graph();
    const std::string name = graph.file.empty() ? "new graph" : graph.file.filename().string();
    return fmt::format("{}{} - Kestrel", session_.document.modified() ? "* " : "", name);
}

bool Editor::busy() const {
    if (!session_.problems().empty() || session_.renderer() == nullptr) return false;
    return session_.playing &&
           (stopAfter == 0 || session_.frames() - framesAtChange_ < static_cast<std::uint64_t>(stopAfter));
}

std::string Editor::selectedPass() const {
    return canvas.selection.size() == 1 ? *canvas.selection.begin() : std::string();
}

// ---- a frame

void Editor::show(const KeyEvents& keys) {
    const bool typing = ImGui::GetIO().WantTextInput;
    if (!palette_.isOpen() && ask_ == Ask::None && question_.empty())
        for (const Chord& key : keys) actions_.press(key, typing);
    follow();
    layOut();
    palette_.show();
    showPopups();
}

void Editor::follow() {
    if (session_.document.revision() != lastRevision_) {
        lastRevision_ = session_.document.revision();
        framesAtChange_ = session_.frames();
    }
    session_.shown = viewport.wanted();
    session_.follow();
    const double now = ImGui::GetTime();
    if (now - lastLook_ > 0.5) { // the disk is looked at twice a second
        lastLook_ = now;
        if (session_.reloadShaders()) framesAtChange_ = session_.frames();
        if (watched_.changed()) {
            try {
                Graph graph = loadGraph(session_.document.graph().file);
                if (!session_.document.modified()) {
                    session_.document.replace("Reload from the disk", std::move(graph));
                    session_.document.markSaved(session_.document.graph().file);
                    say("the file changed on the disk: reloaded");
                } else {
                    changedOnDisk_ = std::move(graph);
                }
            } catch (const Error& error) {
                say("the file changed on the disk and cannot be read: " + error.problems().front().text());
            }
        }
    }
    if (now - lastAutosave_ > 5) {
        lastAutosave_ = now;
        say(autosave_.save(session_.document));
    }
    if (busy() || (session_.renderer() != nullptr && session_.frames() == framesAtChange_)) session_.render();
    numbers_.add(session_);
}

void Editor::layOut() {
    const ImGuiIO& io = ImGui::GetIO();
    if (ImGui::BeginMainMenuBar()) {
        actions_.showMenus();
        ImGui::EndMainMenuBar();
    }
    const float top = ImGui::GetFrameHeight(), status = ImGui::GetTextLineHeightWithSpacing() + 6;
    const float height = std::max(io.DisplaySize.y - top - status, 50.0f);
    const float width = std::round(io.DisplaySize.x * split_);
    const ImGuiWindowFlags fixed = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus;
    ImGui::SetNextWindowPos({0, top});
    ImGui::SetNextWindowSize({width, height});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
    ImGui::Begin("##canvas", nullptr, fixed | ImGuiWindowFlags_NoScrollWithMouse);
    canvas.show(session_, theme_, [this](const std::string& message) { say(message); });
    ImGui::End();
    ImGui::PopStyleVar();
    ImGui::SetNextWindowPos({width, top});
    ImGui::SetNextWindowSize({io.DisplaySize.x - width, height});
    ImGui::Begin("##right", nullptr, fixed);
    showRight(io.DisplaySize.x - width, height);
    ImGui::End();
    ImGui::SetNextWindowPos({0, top + height});
    ImGui::SetNextWindowSize({io.DisplaySize.x, status});
    ImGui::Begin("##status", nullptr, fixed);
    showStatus();
    ImGui::End();
}

void Editor::showRight(float width, float height) {
    ImGui::BeginChild("##viewport", {0, height * rows_});
    viewport.show(session_);
    ImGui::EndChild();
    // The two borders are dragged.
    ImGui::InvisibleButton("##rows", {width, 6});
    if (ImGui::IsItemActive())
        rows_ = std::clamp(rows_ + ImGui::GetIO().MouseDelta.y / std::max(height, 1.0f), 0.15f, 0.85f);
    if (ImGui::IsItemHovered()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeNS);
    ImGui::BeginChild("##tabs");
    showTabs();
    ImGui::EndChild();
    ImGui::SetCursorPos({0, 0});
    ImGui::InvisibleButton("##split", {5, height});
    if (ImGui::IsItemActive())
        split_ =
            std::clamp(split_ + ImGui::GetIO().MouseDelta.x / ImGui::GetIO().DisplaySize.x, 0.15f, 0.85f);
    if (ImGui::IsItemHovered()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
}

void Editor::showTabs() {
    if (!ImGui::BeginTabBar("##tabs")) return;
    const auto tab = [](const char* name, auto body) {
        if (!ImGui::BeginTabItem(name)) return;
        ImGui::BeginChild(name);
        body();
        ImGui::EndChild();
        ImGui::EndTabItem();
    };
    const auto telling = [this](const std::string& message) { say(message); };
    tab("Properties", [&] { properties_.show(session_, selectedPass(), telling); });
    tab("Times", [&] { numbers_.showTimes(session_); });
    tab("Resources", [&] { numbers_.showResources(session_); });
    tab("Left out", [&] {
        numbers_.showLeftOut(session_, [&](const std::string& pass) { canvas.goTo(session_, pass); });
    });
    tab(session_.problems().empty() ? "Problems###problems" : "Problems (!)###problems",
        [&] { showProblems(); });
    tab("History", [&] {
        for (const std::string& step : session_.document.history()) ImGui::TextUnformatted(step.c_str());
    });
    ImGui::EndTabBar();
}

void Editor::showProblems() {
    for (const Marked& marked : session_.problems()) {
        const std::string text = (marked.pass.empty() ? "" : marked.pass + ": ") + marked.message;
        if (ImGui::Selectable(text.c_str()) && !marked.pass.empty()) canvas.goTo(session_, marked.pass);
    }
    if (session_.problems().empty()) ImGui::TextDisabled("nothing is wrong");
    ImGui::Separator();
    for (auto message = messages_.rbegin(); message != messages_.rend(); ++message)
        ImGui::TextWrapped("%s", message->c_str());
}

void Editor::showStatus() {
    const Renderer* renderer = session_.renderer();
    std::string text;
    if (!session_.problems().empty())
        text = fmt::format("{} problem{}: {}", session_.problems().size(),
                           session_.problems().size() == 1 ? "" : "s", session_.problems().front().message);
    else if (renderer != nullptr && session_.frames() > 0)
        text = fmt::format("frame {}  {:.2f} ms  {}x{}  camera {}{}", renderer->last().index,
                           renderer->last().ms, session_.size().width, session_.size().height,
                           renderer->cameraName(),
                           busy()             ? ""
                           : session_.playing ? "  (rests)"
                                              : "  (paused)");
    ImGui::TextUnformatted(text.c_str());
    if (!messages_.empty()) {
        ImGui::SameLine();
        ImGui::TextDisabled("  %s", messages_.back().c_str());
    }
}

// ---- popups

void Editor::showPopups() {
    if (canvas.dropped) addPassByName(std::exchange(canvas.dropped, std::nullopt));
    if (canvas.wantsRename) {
        canvas.selection = {*canvas.wantsRename};
        canvas.wantsRename.reset();
        rename();
    }
    if (canvas.wantsMenu) {
        canvas.wantsMenu = false;
        ImGui::OpenPopup("context");
    }
    if (ImGui::BeginPopup("context")) {
        showContextMenu();
        ImGui::EndPopup();
    }
    if (ask_ != Ask::None) {
        if (askFresh_) ImGui::OpenPopup("##ask");
        if (ImGui::BeginPopupModal("##ask", nullptr,
                                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar)) {
            ImGui::TextUnformatted(ask_ == Ask::Rename   ? "Name"
                                   : ask_ == Ask::SaveAs ? "Save as"
                                   : ask_ == Ask::Note   ? "Note"
                                                         : "Title");
            if (askFresh_) ImGui::SetKeyboardFocusHere();
            askFresh_ = false;
            const bool entered = ImGui::InputText("##typed", &typed_, ImGuiInputTextFlags_EnterReturnsTrue);
            const bool leaves = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
            if (entered) {
                const Ask asked = std::exchange(ask_, Ask::None);
                const std::string typed = typed_;
                if (asked == Ask::SaveAs) save(typed);
                if (asked == Ask::Rename) {
                    say(session_.apply("Rename " + renaming_,
                                       [&](Graph& graph) { renamePass(graph, renaming_, typed); }));
                    if (session_.document.graph().find(typed) != nullptr) canvas.selection = {typed};
                }
                if (asked == Ask::Note)
                    say(session_.apply("Note",
                                       [&](Graph& graph) { addNote(graph, typed, canvas.placeForNew()); }));
                if (asked == Ask::Frame)
                    say(session_.apply("Frame",
                                       [&](Graph& graph) { addFrame(graph, typed, canvas.selection); }));
            }
            if (leaves) ask_ = Ask::None;
            if (ask_ == Ask::None) ImGui::CloseCurrentPopup();
            ImGui::EndPopup();
        }
    }
    if (changedOnDisk_ && question_.empty())
        guard("The file changed on the disk, and what is open is not saved. Take the file's? (Undo brings "
              "yours back.)",
              [this] {
                  session_.document.replace("Reload from the disk", std::move(*changedOnDisk_));
                  changedOnDisk_.reset();
              });
    if (!question_.empty()) {
        ImGui::OpenPopup("##question");
        ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x / 2, ImGui::GetIO().DisplaySize.y / 3},
                                ImGuiCond_Always, {0.5f, 0.5f});
        if (ImGui::BeginPopupModal("##question", nullptr,
                                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar)) {
            ImGui::TextUnformatted(question_.c_str());
            const auto key = [](char letter) {
                return ImGui::GetIO().InputQueueCharacters.contains(static_cast<ImWchar>(letter));
            };
            const bool yes = ImGui::Button("Yes (y)") || key('y');
            ImGui::SameLine();
            const bool no = ImGui::Button("No (n)") || key('n') ||
                            ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
            if (yes || no) {
                question_.clear();
                const std::function<void()> then = std::exchange(afterQuestion_, nullptr);
                if (no) changedOnDisk_.reset();
                if (yes && then) then();
                ImGui::CloseCurrentPopup();
            }
            ImGui::EndPopup();
        }
    }
    if (shortcuts_) {
        ImGui::SetNextWindowSize({ImGui::GetFontSize() * 32, ImGui::GetIO().DisplaySize.y * 0.8f},
                                 ImGuiCond_Appearing);
        if (ImGui::Begin("Shortcuts", &shortcuts_, ImGuiWindowFlags_NoSavedSettings))
            actions_.showShortcuts();
        ImGui::End();
    }
}

void Editor::showContextMenu() {
    // What the menus say of passes and edges, at hand; the rest of the canvas gets what is new.
    const char* menu =
        canvas.menuHit.kind == Hit::Kind::Pass || canvas.menuHit.kind == Hit::Kind::Port ? "Pass" : "Edit";
    if (canvas.menuHit.kind == Hit::Kind::Edge && ImGui::MenuItem("Disconnect"))
        say(session_.apply("Disconnect", [&](Graph& graph) { disconnect(graph, {canvas.menuHit.port}); }));
    if (canvas.menuHit.kind == Hit::Kind::Frame && ImGui::MenuItem("Remove the frame"))
        say(session_.apply("Remove a frame",
                           [&](Graph& graph) { removeFrame(graph, canvas.menuHit.index); }));
    if (canvas.menuHit.kind == Hit::Kind::Note && ImGui::MenuItem("Remove the note"))
        say(session_.apply("Remove a note", [&](Graph& graph) { removeNote(graph, canvas.menuHit.index); }));
    for (const Action& action : actions_.all())
        if (action.menu == menu &&
            ImGui::MenuItem(action.title().c_str(), chordText(action.key).c_str(), false, action.can()))
            action.run();
}

// ---- files

void Editor::guard(const std::string& question, std::function<void()> then) {
    if (!session_.document.modified()) {
        then();
        return;
    }
    question_ = question;
    afterQuestion_ = std::move(then);
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
    else
        session_.setScene(file.string());
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
    watched_.read(file);
    recent_.add(file);
    if (auto copy = autosave_.recover(file)) {
        session_.document.replace("Recover what was not saved", std::move(*copy));
        say("recovered what was not saved when the editor stopped; undo gives the file");
    }
    canvas.selection.clear();
    viewport.pinned.clear();
    viewport.a = viewport.b = {};
    if (!session_.document.graph().outputs.empty())
        viewport.showPort(session_.document.graph().outputs.front().port);
}

void Editor::save(const std::filesystem::path& file) {
    if (file.empty()) {
        ask_ = Ask::SaveAs;
        askFresh_ = true;
        typed_ = "graph.json";
        return;
    }
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
