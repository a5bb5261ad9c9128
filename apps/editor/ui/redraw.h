// What of the window's picture must be drawn anew, so that a moved pointer costs what it changes. On a driver
// that draws with the processor, drawing all of it is most of a frame.
#pragma once
#include <imgui.h>
#include <string>
#include <vector>

namespace kestrel::edit {

// Whole pixels of the screen, rows from the top; its high sides lie outside.
struct PixelBox {
    int left = 0, top = 0, right = 0, bottom = 0;
    [[nodiscard]] bool empty() const { return left >= right || top >= bottom; }
    [[nodiscard]] bool overlaps(const PixelBox& other) const {
        return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
    }
    friend bool operator==(const PixelBox&, const PixelBox&) = default;
};

// Dear ImGui's drawing of a frame against that of the frame before, triangle by triangle.
class Redraw {
public:
    // Boxes without overlap that hold all that differs from the frame before, and whatever shows a texture of
    // `written`, whose content is another. Everything after forget(), where the screen has another size, and
    // where its pixels are not those of the frame buffer. The data is kept for limitTo().
    std::vector<PixelBox> changed(const ImDrawData& data, const std::vector<ImTextureID>& written);
    void forget() { known_ = false; }

    // Leaves in the data what is seen in a box, in its order. Of the data that changed() was given last, as
    // often as one likes, until ImGui's next frame.
    void limitTo(ImDrawData& data, const PixelBox& box) const;

private:
    struct List {
        std::string name;
        std::vector<ImDrawVert> vertices;
        std::vector<ImDrawIdx> indices;
        std::vector<ImDrawCmd> commands;
    };
    struct Triangle;
    static std::vector<Triangle> trianglesOf(const List& list);
    static PixelBox boundsOf(const List& list, const Triangle& triangle);
    static bool same(const List& a, const Triangle& one, const List& b, const Triangle& other);
    static void addDifference(const List& before, const List& now, std::vector<PixelBox>& boxes);
    static void addWritten(const List& list, const std::vector<ImTextureID>& written,
                           std::vector<PixelBox>& boxes);

    std::vector<List> before_, now_;
    ImVec2 size_{0, 0};
    bool known_ = false;
};

} // namespace kestrel::edit
