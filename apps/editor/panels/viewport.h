// Pictures of ports: one, two side by side, or two under a slider; exposure, channels, ranges; the values of
// a pixel.
#pragma once
#include "edit/develop.h"
#include "gl/objects.h"
#include "panels/scene_bar.h"
#include "session.h"
#include <filesystem>
#include <imgui.h>
#include <optional>
#include <string>
#include <utility>
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
    // The same with a picture from a file; colours of a PNG are taken as sRGB. Throws InputError.
    void holdFile(const std::filesystem::path& file);

    // What the session must keep readable: the ports seen, and those pinned.
    [[nodiscard]] std::vector<PortRef> wanted() const;
    std::vector<PortRef> pinned; // previews that stay, beneath the picture

    void show(Session& session, const std::function<void(const std::string&)>& say);
    // The pixel under the pointer, or the one that was clicked last.
    [[nodiscard]] std::optional<std::pair<int, int>> pixel() const { return pixel_; }
    void setPixel(int x, int y) { // and holds it
        pixel_ = {x, y};
        held_ = true;
    }
    // The right button is held over the picture: letters move the camera.
    [[nodiscard]] bool flying() const { return flying_; }
    // Mean square and FLIP of `a` to the second picture, which stands for the reference; empty without one.
    [[nodiscard]] std::string error() const;
    // Where the picture lies on the screen: for tests.
    [[nodiscard]] ImVec2 middle() const { return middle_; }
    // The picture of `a` as it is held, for tests and for saving.
    [[nodiscard]] const Image& image() const { return first_.image; }
    // Textures that got other content since this was asked last.
    [[nodiscard]] std::vector<ImTextureID> takeWritten() { return std::exchange(written_, {}); }

private:
    struct Picture {
        PortRef port;
        std::string title = {}; // in place of the port's name
        Image image;
        std::string whyNot;
        std::uint64_t frame = 0; // of the session, that it is of
        std::string developed;   // how the texture was made
        gl::Texture texture;
        void follow(Session& session, const PortRef& wantedPort);
        bool makeTexture(const Development& development); // true: it has other content
    };
    void develop(Picture& picture, const Development& how);
    void bar();
    void draw(Session& session);
    void drawPicture(Picture& picture, ImVec2 low, ImVec2 high, float from, float to);
    void moveCamera(Session& session, bool hovered, float height);
    void inspector();
    void pins(Session& session);

    SceneBar sceneBar_;
    Picture first_, second_;
    std::vector<Picture> pins_;
    std::vector<ImTextureID> written_;
    std::optional<std::pair<int, int>> pixel_;
    bool held_ = false;      // the pixel was clicked: it stays
    bool heldStill_ = false; // the second picture is one that was kept
    bool flying_ = false, flown_ = false, turning_ = false, onSlider_ = false;
    ImVec2 middle_{0, 0};
    std::string error_;
    std::uint64_t errorOf_ = 0;
};

} // namespace kestrel::edit
