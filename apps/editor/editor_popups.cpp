// What opens over the window: lists, questions, the page of shortcuts.
#include "edit/commands.h"
#include "editor.h"
#include <imgui.h>
#include <imgui_stdlib.h>

namespace kestrel::edit {

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
    showAsked();
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
            const bool no = ImGui::Button("No (n)") || key('n') || keyIsPressed(ImGuiKey_Escape);
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

void Editor::ask(std::string prompt, std::string typed, std::function<void(const std::string&)> then) {
    asked_ = Asked{std::move(prompt), std::move(then)};
    typed_ = std::move(typed);
    askFresh_ = true;
}

void Editor::showAsked() {
    if (!asked_) return;
    if (askFresh_) ImGui::OpenPopup("##ask");
    if (!ImGui::BeginPopupModal("##ask", nullptr,
                                ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar))
        return;
    ImGui::TextUnformatted(asked_->prompt.c_str());
    if (askFresh_) ImGui::SetKeyboardFocusHere();
    askFresh_ = false;
    ImGui::PushItemWidth(ImGui::GetFontSize() * 30);
    const bool entered = ImGui::InputText("##typed", &typed_, ImGuiInputTextFlags_EnterReturnsTrue);
    ImGui::PopItemWidth();
    std::optional<Asked> done;
    if (entered || keyIsPressed(ImGuiKey_Escape)) done = std::exchange(asked_, std::nullopt);
    if (done) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
    if (done && entered) done->then(std::string(typed_)); // may ask again
}

void Editor::guard(const std::string& question, std::function<void()> then) {
    if (!session_.document.modified()) {
        then();
        return;
    }
    question_ = question;
    afterQuestion_ = std::move(then);
}

} // namespace kestrel::edit
