// Keys as GLFW names them, apart from Dear ImGui, whose key codes changed between the versions that Debian
// has.
#pragma once
#include <imgui.h>
#include <string>
#include <vector>

namespace kestrel::edit {

// A key with what is held beside it.
struct Chord {
    int key = 0; // GLFW_KEY_*; 0: none
    bool ctrl = false, shift = false, alt = false;
    friend bool operator==(const Chord&, const Chord&) = default;
};
// "Ctrl+Shift+S"; empty for none. And back; none if it is no such text.
std::string chordText(const Chord& chord);
Chord chordOf(const std::string& text);

// Whether a letter's key ('A' to 'Z') is held; within a frame of Dear ImGui.
bool keyIsDown(char letter);

// Whether one of Dear ImGui's own keys went down in this frame, or repeats.
bool keyIsPressed(ImGuiKey key);

// Keys that went down since the last frame, also by repetition.
using KeyEvents = std::vector<Chord>;

} // namespace kestrel::edit
