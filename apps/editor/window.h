// The window: a GLFW context with Dear ImGui in it, and the loop that draws when something changes.
#pragma once
#include "editor.h"
#include "gl/context.h"
#include <functional>
#include <memory>
#include <vector>

namespace kestrel::edit {

class Window {
public:
    // Throws MachineError where there is no display, naming how to get one.
    Window(Extent size, Theme& theme);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    [[nodiscard]] gl::Context& context() { return *context_; }

    // Until the editor is done. `before` runs at the beginning of each frame, after the window system's
    // events were taken and before anything is shown: tests play a person there.
    void run(Editor& editor, Theme& theme, const std::function<void(KeyEvents&)>& before = {});
    // One frame; false: the window is to close.
    void frame(Editor& editor, Theme& theme, const std::function<void(KeyEvents&)>& before);
    // What is on the screen, RGB, rows from the top.
    [[nodiscard]] Image screenshot() const;
    void resize(Extent size);
    // As run(), for so many seconds.
    void runFor(Editor& editor, Theme& theme, double seconds);
    // How long the last frame took until there was something to draw, ms: all of the editor's but drawing.
    [[nodiscard]] double ownMs() const { return ownMs_; }

private:
    void turn(Editor& editor, Theme& theme, const std::function<void(KeyEvents&)>& before);

    std::unique_ptr<gl::Context> context_;
    KeyEvents keys_;
    std::vector<std::filesystem::path> dropped_;
    double ownMs_ = 0;
    int settle_ = 3; // frames to draw before it may rest: popups and hovers need a few
};

} // namespace kestrel::edit
