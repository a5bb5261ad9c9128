#include "ui/actions.h"
#include "edit/search.h"
#include <algorithm>
#include <imgui.h>
#include <imgui_stdlib.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace kestrel::edit {
namespace {

#if IMGUI_VERSION_NUM < 18700
constexpr ImGuiKey keypadEnter = ImGuiKey_KeyPadEnter;
#else
constexpr ImGuiKey keypadEnter = ImGuiKey_KeypadEnter;
#endif

} // namespace

bool Actions::press(const Chord& key, bool typing) const {
    const bool function = key.key >= GLFW_KEY_F1 && key.key <= GLFW_KEY_F12;
    if (typing && !key.ctrl && !function) return false;
    // A text field has these for itself.
    if (typing && key.ctrl &&
        (key.key == 'C' || key.key == 'V' || key.key == 'X' || key.key == 'A' || key.key == 'Z'))
        return false;
    for (const Action& action : actions_)
        if (action.key.key != 0 && action.key == key && action.can()) {
            action.run();
            return true;
        }
    return false;
}

void Actions::showMenus() const {
    std::vector<std::string> menus;
    for (const Action& action : actions_)
        if (std::find(menus.begin(), menus.end(), action.menu) == menus.end()) menus.push_back(action.menu);
    for (const std::string& menu : menus) {
        if (!ImGui::BeginMenu(menu.c_str())) continue;
        for (const Action& action : actions_)
            if (action.menu == menu &&
                ImGui::MenuItem(action.title().c_str(), chordText(action.key).c_str(), false, action.can()))
                action.run();
        ImGui::EndMenu();
    }
}

void Actions::showShortcuts() const {
    if (!ImGui::BeginTable("shortcuts", 3, ImGuiTableFlags_RowBg)) return;
    for (const Action& action : actions_) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(chordText(action.key).c_str());
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(action.menu.c_str());
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(action.name.c_str());
    }
    ImGui::EndTable();
}

void Palette::open(std::string prompt, std::vector<Entry> entries, Finder finder) {
    finder_ = std::move(finder);
    prompt_ = std::move(prompt);
    entries_ = std::move(entries);
    typed_.clear();
    chosen_ = 0;
    open_ = fresh_ = true;
}

void Palette::show() {
    if (!open_) return;
    const ImGuiIO& io = ImGui::GetIO();
    const float width = std::min(io.DisplaySize.x * 0.8f, ImGui::GetFontSize() * 40);
    ImGui::SetNextWindowPos({io.DisplaySize.x / 2, io.DisplaySize.y * 0.15f}, ImGuiCond_Always, {0.5f, 0});
    ImGui::SetNextWindowSize({width, 0});
    if (fresh_) ImGui::SetNextWindowFocus();
    ImGui::Begin("##palette", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
    ImGui::TextUnformatted(prompt_.c_str());
    if (fresh_) ImGui::SetKeyboardFocusHere();
    ImGui::PushItemWidth(-1);
    if (ImGui::InputText("##typed", &typed_)) chosen_ = 0;
    ImGui::PopItemWidth();
    std::vector<std::pair<int, const Entry*>> found;
    for (const Entry& entry : entries_)
        if (const int rank = matchRank(entry.title, typed_); rank >= 0) found.push_back({rank, &entry});
    if (finder_ && !typed_.empty())
        for (const std::string& title : finder_(typed_))
            for (const Entry& entry : entries_)
                if (entry.title == title && matchRank(title, typed_) < 0) found.push_back({10'000, &entry});
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    if (!found.empty()) {
        if (keyIsPressed(ImGuiKey_DownArrow)) chosen_ = (chosen_ + 1) % found.size();
        if (keyIsPressed(ImGuiKey_UpArrow)) chosen_ = (chosen_ + found.size() - 1) % found.size();
        chosen_ = std::min(chosen_, found.size() - 1);
    }
    const Entry* taken = nullptr;
    ImGui::BeginChild("##found", {0, ImGui::GetTextLineHeightWithSpacing() * 12});
    for (size_t i = 0; i < found.size(); ++i) {
        const std::string line = found[i].second->title + "  " + found[i].second->detail;
        if (ImGui::Selectable(line.c_str(), i == chosen_)) taken = found[i].second;
        if (i == chosen_) ImGui::SetScrollHereY();
    }
    ImGui::EndChild();
    if (!fresh_ && (keyIsPressed(ImGuiKey_Enter) || keyIsPressed(keypadEnter)) && !found.empty())
        taken = found[chosen_].second;
    const bool leaves = keyIsPressed(ImGuiKey_Escape) ||
                        (!fresh_ && !ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows));
    ImGui::End();
    fresh_ = false;
    if (taken != nullptr) {
        const std::function<void()> run = taken->run;
        open_ = false;
        run(); // may open another
    } else if (leaves) {
        open_ = false;
    }
}

} // namespace kestrel::edit
