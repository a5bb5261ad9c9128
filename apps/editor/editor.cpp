#include "editor.h"
#include "apart.h"
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
    addCameraActions();
    addCaptureActions();
    const Graph& graph = session_.document.graph();
    if (!graph.outputs.empty()) viewport.showPort(graph.outputs.front().port);
    takeFile(graph.file);
}

void Editor::say(const std::string& message) {
    if (message.empty()) return;
    ++told_;
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
    if (recording_ || viewport.flying()) return true;
    return session_.playing && (stopAfter == 0 || session_.timeRuns() ||
                                session_.settled() < static_cast<std::uint64_t>(stopAfter));
}

std::string Editor::selectedPass() const {
    return canvas.selection.size() == 1 ? *canvas.selection.begin() : std::string();
}

// ---- a frame

void Editor::show(const KeyEvents& keys) {
    const bool typing = ImGui::GetIO().WantTextInput;
    if (!palette_.isOpen() && !asked_ && question_.empty() && !viewport.flying())
        for (const Chord& key : keys) actions_.press(key, typing);
    follow();
    layOut();
    palette_.show();
    showPopups();
}

void Editor::follow() {
    session_.shown = viewport.wanted();
    session_.follow();
    const double now = ImGui::GetTime();
    if (now - lastLook_ > 0.5) { // the disk is looked at twice a second
        lastLook_ = now;
        lookAtDisk();
    }
    if (now - lastAutosave_ > 5) {
        lastAutosave_ = now;
        say(autosave_.save(session_.document));
    }
    if (recording_)
        record();
    else if (busy() || session_.due())
        session_.render();
    numbers_.add(session_);
}

// Shaders, pictures, plugins and the graph's file, where another program wrote them.
void Editor::lookAtDisk() {
    session_.reloadFiles();
    if (plugins != nullptr) {
        bool changed = false;
        for (const std::string& told : plugins->follow(changed)) say(told);
        if (changed) session_.takeTypes();
    }
    if (!watched_.changed()) return;
    try {
        Graph graph = loadGraph(session_.document.graph().file);
        if (session_.document.modified()) {
            changedOnDisk_ = std::move(graph);
            return;
        }
        session_.document.replace("Reload from the disk", std::move(graph));
        session_.document.markSaved(session_.document.graph().file);
        say("the file changed on the disk: reloaded");
    } catch (const Error& error) {
        say("the file changed on the disk and cannot be read: " + error.problems().front().text());
    }
}

bool Editor::rests() {
    const std::uint64_t told = told_;
    lookAtDisk();
    say(autosave_.save(session_.document));
    return told == told_ && !session_.due() && !changedOnDisk_;
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
    viewport.show(session_, [this](const std::string& message) { say(message); });
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
    tab("Resources", [&] {
        numbers_.showResources(session_,
                               [&](const PortRef& port) { say(toggleApart(session_, port, viewport.a)); });
    });
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

} // namespace kestrel::edit
