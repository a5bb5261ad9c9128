// Plays a person at the editor's window: keys, letters and the mouse, frame by frame, through the same events
// that a window system would make.
#pragma once
#include "support/folders.h"
#include "support/temporary_folder.h"
#include "window.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <imgui.h>
#include <thread>

namespace kestrel::test {

class Person {
public:
    Person(edit::Window& window, edit::Editor& editor, edit::Session& session, edit::Theme& theme)
        : window_(window)
        , editor_(editor)
        , session_(session)
        , theme_(theme) {}

    // ---- what a person does; each counts as one action but waiting
    void press(const std::string& chord) {
        ++actions_;
        const edit::Chord key = edit::chordOf(chord);
        ASSERT_NE(key.key, 0) << chord;
        down_ = key.key;
        chord_ = key;
        frame({key});
        down_ = 0;
        chord_ = {};
        frame();
    }
    void type(const std::string& text) {
        ++actions_;
        for (const char letter : text) {
            ImGui::GetIO().AddInputCharacter(static_cast<unsigned>(letter));
            frame();
        }
    }
    void moveTo(glm::dvec2 screen) {
        mouse_ = screen;
        frame();
        frame();
    }
    void click(glm::dvec2 screen, int button = 0) {
        ++actions_;
        moveTo(screen);
        button_[button] = true;
        frame();
        button_[button] = false;
        frame();
        frame();
    }
    void doubleClick(glm::dvec2 screen) {
        click(screen);
        click(screen);
        --actions_;
    }
    void drag(glm::dvec2 from, glm::dvec2 to, int button = 0) {
        ++actions_;
        moveTo(from);
        button_[button] = true;
        frame();
        for (int i = 1; i <= 6; ++i) {
            mouse_ = from + (to - from) * (static_cast<double>(i) / 6);
            frame();
        }
        frame();
        button_[button] = false;
        frame();
        frame();
    }
    void wheel(glm::dvec2 screen, float by) {
        ++actions_;
        moveTo(screen);
        wheel_ = by;
        frame();
        wheel_ = 0;
        frame();
    }
    bool ctrl = false, shift = false, alt = false; // held while the mouse works
    // A letter's key stays down for some frames, and with it a button of the mouse.
    void hold(char key, glm::dvec2 screen, int button, int frames) {
        ++actions_;
        moveTo(screen);
        button_[button] = true;
        frame();
        down_ = key;
        wait(frames);
        down_ = 0;
        button_[button] = false;
        wait(2);
    }
    void wait(int frames) {
        for (int i = 0; i < frames; ++i) frame();
    }
    // Until the graph rests.
    void rest() {
        for (int i = 0; i < 500 && (i < 3 || editor_.busy()); ++i) frame();
    }
    [[nodiscard]] int actions() const { return actions_; }

    // ---- where things are
    [[nodiscard]] glm::dvec2 port(const std::string& pass, const std::string& name) const {
        const edit::Box* box = edit::boxOf(editor_.canvas.boxes(), pass);
        const edit::PortPlace* place = box != nullptr ? box->find({pass, name}) : nullptr;
        EXPECT_NE(place, nullptr) << pass << "." << name;
        return place != nullptr ? screen(place->at) : glm::dvec2(0);
    }
    [[nodiscard]] glm::dvec2 box(const std::string& pass) const { // in its header
        const edit::Box* found = edit::boxOf(editor_.canvas.boxes(), pass);
        EXPECT_NE(found, nullptr) << pass;
        return found != nullptr ? screen({(found->low.x + found->high.x) / 2, found->low.y + 14})
                                : glm::dvec2(0);
    }
    [[nodiscard]] glm::dvec2 screen(glm::dvec2 canvas) const {
        return editor_.canvas.view.toScreen(canvas) + editor_.canvas.corner();
    }

    void frame(edit::KeyEvents keys = {}) {
        window_.frame(editor_, theme_, [&](edit::KeyEvents& events) {
            events = std::move(keys);
            ImGuiIO& io = ImGui::GetIO();
            io.DeltaTime = 1.0f / 60;
            const bool control = ctrl || chord_.ctrl, shifted = shift || chord_.shift,
                       alternate = alt || chord_.alt;
#if IMGUI_VERSION_NUM < 18700
            io.MousePos = {static_cast<float>(mouse_.x), static_cast<float>(mouse_.y)};
            for (int i = 0; i < 3; ++i) io.MouseDown[i] = button_[i];
            io.MouseWheel = wheel_;
            io.KeyCtrl = control;
            io.KeyShift = shifted;
            io.KeyAlt = alternate;
            for (bool& key : io.KeysDown) key = false;
            if (down_ > 0) io.KeysDown[down_] = true;
#else
            io.AddMousePosEvent(static_cast<float>(mouse_.x), static_cast<float>(mouse_.y));
            for (int i = 0; i < 3; ++i) io.AddMouseButtonEvent(i, button_[i]);
            if (wheel_ != 0) io.AddMouseWheelEvent(0, wheel_);
            io.AddKeyEvent(ImGuiMod_Ctrl, control);
            io.AddKeyEvent(ImGuiMod_Shift, shifted);
            io.AddKeyEvent(ImGuiMod_Alt, alternate);
            const std::pair<const char*, ImGuiKey> known[] = {
                {"Enter", ImGuiKey_Enter}, {"Esc", ImGuiKey_Escape}, {"Down", ImGuiKey_DownArrow}, {"Up", ImGuiKey_UpArrow}};
            for (int letter = 0; letter < 26; ++letter)
                io.AddKeyEvent(static_cast<ImGuiKey>(ImGuiKey_A + letter), down_ == 'A' + letter);
            for (const auto& [name, key] : known) io.AddKeyEvent(key, down_ > 0 && edit::chordOf(name).key == down_);
#endif
        });
        EXPECT_TRUE(window_.present());
    }

private:
    edit::Window& window_;
    edit::Editor& editor_;
    edit::Session& session_;
    edit::Theme& theme_;
    glm::dvec2 mouse_{-100, -100};
    bool button_[3] = {};
    float wheel_ = 0;
    int down_ = 0, actions_ = 0;
    edit::Chord chord_;
};

} // namespace kestrel::test
