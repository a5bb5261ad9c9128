#include "ui/theme.h"
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

namespace kestrel::edit {
namespace {

// Sizes in pixels at a scale of 1; the second is the text of widgets.
constexpr std::array<float, 6> sizes{9, 14, 19, 26, 36, 52};
constexpr const char* fontFile = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

} // namespace

void Theme::loadFonts() {
    ImGuiIO& io = ImGui::GetIO();
    io.Fonts->Clear();
    std::error_code ignored;
    const bool found = std::filesystem::is_regular_file(fontFile, ignored);
    ImFont* usual = nullptr;
    for (const float size : sizes) {
        ImFontConfig config;
        config.SizePixels = std::round(size * scale);
        ImFont* font = found ? io.Fonts->AddFontFromFileTTF(fontFile, config.SizePixels)
                             : io.Fonts->AddFontDefault(&config);
        if (size == sizes[1]) usual = font;
    }
    io.FontDefault = usual;
}

void Theme::apply() const {
    ImGuiStyle style;
    if (dark)
        ImGui::StyleColorsDark(&style);
    else
        ImGui::StyleColorsLight(&style);
    style.WindowRounding = 0;
    style.FrameRounding = 3;
    style.GrabRounding = 3;
    style.WindowBorderSize = 1;
    style.FrameBorderSize = dark ? 0.0f : 1.0f; // fields are as white as what they lie on
    style.ScaleAllSizes(scale);
    ImGui::GetStyle() = style;
}

ImFont* Theme::fontFor(float pixels) const {
#if IMGUI_VERSION_NUM < 19200
    const auto sizeOf = [](const ImFont& font) { return font.FontSize; };
#else
    const auto sizeOf = [](const ImFont& font) { return font.LegacySize; };
#endif
    ImFont* nearest = nullptr;
    float distance = std::numeric_limits<float>::max();
    for (ImFont* font : ImGui::GetIO().Fonts->Fonts) {
        const float apart = std::abs(std::log(sizeOf(*font) / std::max(pixels, 1.0f)));
        if (apart >= distance) continue;
        distance = apart;
        nearest = font;
    }
    return nearest;
}

ImU32 Theme::canvas() const { return dark ? IM_COL32(28, 30, 34, 255) : IM_COL32(238, 239, 242, 255); }
ImU32 Theme::grid() const { return dark ? IM_COL32(255, 255, 255, 14) : IM_COL32(0, 0, 0, 18); }
ImU32 Theme::box() const { return dark ? IM_COL32(52, 56, 64, 255) : IM_COL32(255, 255, 255, 255); }
ImU32 Theme::text(bool faded) const {
    const int alpha = faded ? (dark ? 120 : 150) : 255;
    return dark ? IM_COL32(228, 230, 234, alpha) : IM_COL32(24, 26, 30, alpha);
}
ImU32 Theme::outline(bool selected) const {
    if (selected) return IM_COL32(255, 170, 50, 255);
    return dark ? IM_COL32(14, 15, 17, 255) : IM_COL32(160, 164, 172, 255);
}
ImU32 Theme::frame() const { return dark ? IM_COL32(110, 140, 190, 40) : IM_COL32(90, 120, 180, 40); }
ImU32 Theme::note() const { return dark ? IM_COL32(120, 110, 60, 90) : IM_COL32(255, 240, 170, 200); }

ImU32 Theme::port(PortKind kind, bool faded) {
    const int alpha = faded ? 90 : 255;
    switch (kind) {
    case PortKind::Texture:
        return IM_COL32(96, 165, 250, alpha);
    case PortKind::Buffer:
        return IM_COL32(148, 163, 184, alpha);
    case PortKind::Tracer:
        return IM_COL32(251, 146, 60, alpha);
    case PortKind::Hits:
        return IM_COL32(244, 114, 182, alpha);
    case PortKind::Layers:
        return IM_COL32(52, 211, 153, alpha);
    case PortKind::Radiance:
        return IM_COL32(250, 204, 21, alpha);
    }
    return IM_COL32_WHITE;
}

} // namespace kestrel::edit
