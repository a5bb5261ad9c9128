// The window: a GLFW context with Dear ImGui in it, and the loop that draws when something changes.
#pragma once
#include "editor.h"
#include "gl/context.h"
#include "gl/objects.h"
#include "ui/redraw.h"
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
    // One frame: of the picture what became another is drawn.
    void frame(Editor& editor, Theme& theme, const std::function<void(KeyEvents&)>& before);
    // Shows the frame, if it is another than the one on the screen, and takes the window system's events;
    // false: the window is to close.
    bool present();
    // The last frame's picture, RGB, rows from the top.
    [[nodiscard]] Image screenshot() const;
    // The last frame once more, all of it: the same picture, if what changed was found.
    void drawAgain();
    // Pixels of all boxes that were drawn so far.
    [[nodiscard]] std::uint64_t drawnPixels() const { return drawnPixels_; }
    void resize(Extent size);
    // As run(), for so many seconds.
    void runFor(Editor& editor, Theme& theme, double seconds);
    // How long the last frame took until there was something to draw, ms: all of the editor's but drawing.
    [[nodiscard]] double ownMs() const { return ownMs_; }

private:
    void turn(Editor& editor, Theme& theme, const std::function<void(KeyEvents&)>& before);
    void draw(Editor& editor);
    void drawBox(const PixelBox& box);

    std::unique_ptr<gl::Context> context_;
    KeyEvents keys_;
    std::vector<std::filesystem::path> dropped_;
    Redraw redraw_;
    gl::Texture picture_; // what is shown, since a window's own buffer is lost when it is
    gl::FramebufferCache framebuffers_;
    std::string title_;
    bool shows_ = false;   // the picture on the screen is the last frame's
    bool exposed_ = false; // the window system lost what was on the screen
    std::uint64_t drawnPixels_ = 0;
    double ownMs_ = 0;
    int settle_ = 3; // frames to draw before it may rest: popups and hovers need a few
};

} // namespace kestrel::edit
