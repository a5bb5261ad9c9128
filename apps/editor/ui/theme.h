// Fonts and colours.
#pragma once
#include "graph/types.h"
#include <imgui.h>

namespace kestrel::edit {

struct Theme {
    bool dark = true;
    float scale = 1; // of all text and widgets: 2 is 200 %

    // Bakes fonts for `scale`; before the first frame, or between frames after which the font texture is made
    // anew.
    void loadFonts();
    void apply() const; // ImGui's style

    // The baked font nearest to a size in pixels, so that text is crisp at any zoom.
    [[nodiscard]] ImFont* fontFor(float pixels) const;

    [[nodiscard]] ImU32 canvas() const;
    [[nodiscard]] ImU32 grid() const;
    [[nodiscard]] ImU32 box() const;
    [[nodiscard]] ImU32 text(bool faded = false) const;
    [[nodiscard]] ImU32 outline(bool selected) const;
    [[nodiscard]] ImU32 frame() const;
    [[nodiscard]] ImU32 note() const;
    static ImU32 mistake() { return IM_COL32(230, 70, 60, 255); }
    static ImU32 port(PortKind kind, bool faded = false);
};

} // namespace kestrel::edit
