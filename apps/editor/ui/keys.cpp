#include "ui/keys.h"
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <array>
#include <imgui.h>
#include <utility>

namespace kestrel::edit {
namespace {

constexpr std::array<std::pair<int, const char*>, 27> names{{
    {GLFW_KEY_ENTER, "Enter"}, {GLFW_KEY_ESCAPE, "Esc"},  {GLFW_KEY_TAB, "Tab"},
    {GLFW_KEY_SPACE, "Space"}, {GLFW_KEY_DELETE, "Del"},  {GLFW_KEY_BACKSPACE, "Backspace"},
    {GLFW_KEY_LEFT, "Left"},   {GLFW_KEY_RIGHT, "Right"}, {GLFW_KEY_UP, "Up"},
    {GLFW_KEY_DOWN, "Down"},   {GLFW_KEY_HOME, "Home"},   {GLFW_KEY_END, "End"},
    {GLFW_KEY_F1, "F1"},       {GLFW_KEY_F2, "F2"},       {GLFW_KEY_F3, "F3"},
    {GLFW_KEY_F4, "F4"},       {GLFW_KEY_F5, "F5"},       {GLFW_KEY_F6, "F6"},
    {GLFW_KEY_F7, "F7"},       {GLFW_KEY_F8, "F8"},       {GLFW_KEY_F9, "F9"},
    {GLFW_KEY_F11, "F11"},     {GLFW_KEY_F12, "F12"},     {GLFW_KEY_COMMA, ","},
    {GLFW_KEY_PERIOD, "."},    {GLFW_KEY_MINUS, "-"},     {GLFW_KEY_EQUAL, "="},
}};

} // namespace

std::string chordText(const Chord& chord) {
    if (chord.key == 0) return {};
    std::string text;
    if (chord.ctrl) text += "Ctrl+";
    if (chord.shift) text += "Shift+";
    if (chord.alt) text += "Alt+";
    for (const auto& [key, name] : names)
        if (key == chord.key) return text + name;
    // Letters and digits have the codes of their capitals.
    return text + static_cast<char>(chord.key);
}

Chord chordOf(const std::string& text) {
    Chord chord;
    std::string rest = text;
    const auto take = [&](const char* prefix, bool& held) {
        held = rest.starts_with(prefix);
        if (held) rest.erase(0, std::string(prefix).size());
    };
    take("Ctrl+", chord.ctrl);
    take("Shift+", chord.shift);
    take("Alt+", chord.alt);
    for (const auto& [key, name] : names)
        if (rest == name) chord.key = key;
    if (chord.key == 0 && rest.size() == 1) chord.key = static_cast<unsigned char>(rest[0]);
    return chord.key == 0 ? Chord() : chord;
}

bool keyIsDown(char letter) {
#if IMGUI_VERSION_NUM < 18700
    return ImGui::IsKeyDown(letter); // the numbers of the window system, here GLFW's
#else
    return ImGui::IsKeyDown(static_cast<ImGuiKey>(ImGuiKey_A + (letter - 'A')));
#endif
}

bool keyIsPressed(ImGuiKey key) {
#if IMGUI_VERSION_NUM < 18700
    return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key));
#else
    return ImGui::IsKeyPressed(key);
#endif
}

} // namespace kestrel::edit
