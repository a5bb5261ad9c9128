// Pictures of ports: one, two side by side, or two under a slider; exposure, channels, ranges; the values of
// a pixel.
#pragma once
#include "edit/develop.h"
#include "gl/objects.h"
#include "session.h"
#include <imgui.h>
#include <optional>
#include <string>
#include <vector>

namespace kestrel::edit {

class Viewport {
public:
    enum class Layout { One, Split, Slider };
    Layout layout = Layout::One;
    PortRef a, b; // what is seen; `b` where the layout has two
    Development development;
    bool automatic = false; // the range follows the picture
    float slider = 0.5f;
    float zoom = 0; // screen pixels a pixel; 0: as large as fits

    // Shows a port; the one before becomes `b`.
    void showPort(const PortRef& port);
    // Keeps the picture as it is now as the second one, under the slider: what comes next is compared with
    // it.
    void hold();
    [[nodiscard]] bool holds() const { return heldStill_; }
    void letGo() { heldStill_ = false; }

    // What the session must keep readable: the ports seen, and those pinned.
    [[nodiscard]] std::vector<PortRef> wanted() const;
    std::vector<PortRef> pinned; // previews that stay, beneath the picture

    void show(Session& session);
    // The pixel under the pointer, or the one that was clicked last.
    [[nodiscard]] std::optional<std::pair<int, int>> pixel() const { return pixel_; }
    void setPixel(int x, int y) { pixel_ = {x, y}; }
    // The picture of `a` as it is held, for tests and for saving.
    [[nodiscard]] const Image& image() const { return first_.image; }

private:
    struct Picture {
        PortRef port;
        Image image;
        std::string whyNot;
        std::uint64_t frame = 0; // of the session, that it is of
        std::string developed;   // how the texture was made
        gl::Texture texture;
        void follow(Session& session, const PortRef& wantedPort);
        void makeTexture(const Development& development);
    };
    void bar();
    void draw(Session& session);
    void drawPicture(Picture& picture, ImVec2 low, ImVec2 high, float from, float to);
    void inspector();
    void pins(Session& session);
    [[nodiscard]] std::string errorText() const;

    Picture first_, second_;
    std::vector<Picture> pins_;
    std::optional<std::pair<int, int>> pixel_;
    bool held_ = false;      // the pixel was clicked: it stays
    bool heldStill_ = false; // the second picture is one that was kept
    std::string error_;
    std::uint64_t errorOf_ = 0;
};

} // namespace kestrel::edit
