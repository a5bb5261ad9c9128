#include "panels/viewport.h"
#include "image/flip.h"
#include "image/io.h"
#include "image/metrics.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <type_traits>

namespace kestrel::edit {
namespace {

// A pointer before Dear ImGui 1.91.4, a number since.
template<class Id = ImTextureID>
Id textureId(const gl::Texture& texture) {
    if constexpr (std::is_pointer_v<Id>)
        return reinterpret_cast<Id>(static_cast<std::intptr_t>(texture.name()));
    else
        return static_cast<Id>(texture.name());
}

} // namespace

void Viewport::showPort(const PortRef& port) {
    if (port == a) return;
    b = a;
    a = port;
}

void Viewport::hold() {
    if (first_.image.empty()) return;
    second_ = Picture{
        .port = first_.port, .image = first_.image, .whyNot = {}, .frame = 0, .developed = {}, .texture = {}};
    heldStill_ = true;
    errorOf_ = 0;
    if (layout == Layout::One) layout = Layout::Slider;
}

void Viewport::holdFile(const std::filesystem::path& file) {
    Picture held;
    const kestrel::Picture read = readPicture(file);
    const bool coded = read.format == ImageFormat::Png && read.image.channels >= 3;
    held.image = coded ? srgbToLinear(read.image) : read.image;
    held.title = file.filename().string();
    second_ = std::move(held);
    heldStill_ = true;
    errorOf_ = 0;
    if (layout == Layout::One) layout = Layout::Slider;
}

std::vector<PortRef> Viewport::wanted() const {
    std::vector<PortRef> ports = pinned;
    for (const PortRef* port : {&a, &b})
        if (!port->pass.empty() && (port == &a || (layout != Layout::One && !heldStill_)) &&
            std::find(ports.begin(), ports.end(), *port) == ports.end())
            ports.push_back(*port);
    return ports;
}

void Viewport::Picture::follow(Session& session, const PortRef& wantedPort) {
    if (port == wantedPort && frame == session.frames()) return;
    const bool other = port != wantedPort;
    port = wantedPort;
    frame = session.frames();
    std::string why;
    Image now = session.read(port, why);
    // The last good picture stays while something is wrong.
    if (now.empty() && !other && !image.empty()) {
        whyNot = why;
        return;
    }
    image = std::move(now);
    whyNot = why;
    developed.clear();
}

bool Viewport::Picture::makeTexture(const Development& development) {
    const std::string how = fmt::format("{} {} {} {}", static_cast<int>(development.mode),
                                        development.exposure, development.low, development.high);
    if (image.empty() || how == developed) return false;
    developed = how;
    const std::vector<std::uint8_t> pixels = edit::develop(image, development);
    const Extent extent{static_cast<std::uint32_t>(image.width), static_cast<std::uint32_t>(image.height), 1};
    if (!texture || texture.desc().extent != extent)
        texture = gl::Texture(Desc::texture2D(Format::RGBA8, extent), "viewport");
    texture.upload(pixels.data());
    return true;
}

void Viewport::develop(Picture& picture, const Development& how) {
    if (picture.makeTexture(how)) written_.push_back(textureId(picture.texture));
}

void Viewport::show(Session& session, const std::function<void(const std::string&)>& say) {
    first_.follow(session, a);
    if (layout != Layout::One && !heldStill_) second_.follow(session, b);
    if (automatic && !first_.image.empty()) automaticRange(first_.image, development);
    bar();
    sceneBar_.show(session, say);
    draw(session);
}

void Viewport::bar() {
    const float em = ImGui::GetFontSize();
    // Beside the item before where there is room, else beneath it.
    const auto next = [&](float width) {
        const float spacing = ImGui::GetStyle().ItemSpacing.x;
        const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
        if (ImGui::GetItemRectMax().x + spacing + width <= right) ImGui::SameLine();
        ImGui::SetNextItemWidth(width);
    };
    int mode = static_cast<int>(development.mode), shown = static_cast<int>(layout);
    ImGui::SetNextItemWidth(7 * em);
    if (ImGui::Combo("##mode", &mode, developmentNames, IM_ARRAYSIZE(developmentNames)))
        development.mode = static_cast<Development::Mode>(mode);
    next(7 * em);
    if (ImGui::Combo("##layout", &shown, "one\0split\0slider\0")) layout = static_cast<Layout>(shown);
    next(7 * em);
    ImGui::DragFloat("##exposure", &development.exposure, 0.05f, -16, 16, "exposure %.2f");
    next(5 * em);
    ImGui::DragFloat("##low", &development.low, 0.01f, 0, 0, "from %.3g");
    next(5 * em);
    ImGui::DragFloat("##high", &development.high, 0.01f, 0, 0, "to %.3g");
    next(4 * em);
    ImGui::Checkbox("auto", &automatic);
}

std::string Viewport::error() const {
    if (layout == Layout::One || first_.image.empty() || second_.image.empty()) return {};
    if (!first_.image.sameSize(second_.image)) return "sizes differ";
    return error_;
}

void Viewport::draw(Session& session) {
    develop(first_, development);
    develop(second_, development);
    if (layout != Layout::One && errorOf_ != session.frames() && first_.image.sameSize(second_.image) &&
        !first_.image.empty()) {
        errorOf_ = session.frames();
        try {
            const Image one = convertChannels(first_.image, 3), other = convertChannels(second_.image, 3);
            error_ = fmt::format("MSE {:.3g}  FLIP {:.4f}", meanSquaredError(other, one),
                                 flip(linearToSrgb(other), linearToSrgb(one)).figures.mean);
        } catch (const Error& error) { // a value that is not finite
            error_ = error.problems().front().message;
        }
    }
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImVec2 room = ImGui::GetContentRegionAvail();
    const float beneath = ImGui::GetTextLineHeightWithSpacing() * (pinned.empty() ? 4.5f : 12.0f);
    room.y = std::max(room.y - beneath, 40.0f);
    middle_ = {corner.x + room.x / 2, corner.y + room.y / 2};
    ImGui::InvisibleButton("picture", {std::max(room.x, 1.0f), std::max(room.y, 1.0f)});
    const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->PushClipRect(corner, {corner.x + room.x, corner.y + room.y}, true);
    if (first_.image.empty()) {
        const std::string text = a.pass.empty() ? "Choose a port: click it on the canvas and press V"
                                                : a.text() + ": " + first_.whyNot;
        list->AddText({corner.x + 8, corner.y + 8}, ImGui::GetColorU32(ImGuiCol_Text), text.c_str());
    } else {
        const bool split = layout == Layout::Split;
        const float half = split ? room.x / 2 : room.x;
        const auto width = static_cast<float>(first_.image.width),
                   height = static_cast<float>(first_.image.height);
        const float scale = zoom > 0 ? zoom : std::min(half / width, room.y / height);
        const ImVec2 low(corner.x + (half - width * scale) / 2, corner.y + (room.y - height * scale) / 2);
        const ImVec2 high(low.x + width * scale, low.y + height * scale);
        drawPicture(first_, low, high, 0, layout == Layout::Slider ? slider : 1);
        if (layout == Layout::Slider) {
            drawPicture(second_, low, high, slider, 1);
            const float x = low.x + (high.x - low.x) * slider;
            list->AddLine({x, low.y}, {x, high.y}, IM_COL32(255, 255, 255, 200), 2);
            if (ImGui::IsMouseClicked(ImGuiMouseButton_Left))
                onSlider_ = hovered && std::abs(ImGui::GetIO().MousePos.x - x) < 10;
            if (active && onSlider_)
                slider = std::clamp((ImGui::GetIO().MousePos.x - low.x) / (high.x - low.x), 0.0f, 1.0f);
        }
        const ImVec2 foot(low.x + 4, high.y - ImGui::GetTextLineHeight() - 4);
        const std::string error = this->error();
        list->AddText({foot.x + 1, foot.y + 1}, IM_COL32(0, 0, 0, 255), error.c_str());
        list->AddText(foot, IM_COL32_WHITE, error.c_str());
        if (split) drawPicture(second_, {low.x + half, low.y}, {high.x + half, high.y}, 0, 1);
        const ImVec2 mouse = ImGui::GetIO().MousePos;
        const int x = static_cast<int>(std::floor((mouse.x - low.x) / scale)),
                  y = static_cast<int>(std::floor((mouse.y - low.y) / scale));
        const bool inside = x >= 0 && y >= 0 && x < first_.image.width && y < first_.image.height;
        if (hovered && ImGui::IsMouseReleased(ImGuiMouseButton_Right) && !flown_) held_ = inside && !held_;
        if (hovered && inside && !held_) pixel_ = {x, y};
        if (held_ && pixel_) {
            const ImVec2 at(low.x + (static_cast<float>(pixel_->first) + 0.5f) * scale,
                            low.y + (static_cast<float>(pixel_->second) + 0.5f) * scale);
            list->AddRect({at.x - 4, at.y - 4}, {at.x + 4, at.y + 4}, IM_COL32(255, 170, 50, 255));
        }
    }
    list->PopClipRect();
    if (layout != Layout::Slider) onSlider_ = false;
    moveCamera(session, hovered, room.y);
    inspector();
    pins(session);
}

// Pinned ports, small, beneath each other's names; a click brings one up, a right click takes it away.
void Viewport::pins(Session& session) {
    pins_.resize(pinned.size());
    std::optional<size_t> gone;
    for (size_t i = 0; i < pinned.size(); ++i) {
        Picture& pin = pins_[i];
        pin.follow(session, pinned[i]);
        develop(pin, {});
        if (i > 0) ImGui::SameLine();
        ImGui::BeginGroup();
        ImGui::TextUnformatted(pinned[i].text().c_str());
        if (pin.texture && !pin.image.empty()) {
            const float height = ImGui::GetFontSize() * 6;
            ImGui::Image(textureId(pin.texture),
                         {height * static_cast<float>(pin.image.width) / static_cast<float>(pin.image.height),
                          height});
        } else {
            ImGui::TextUnformatted(pin.whyNot.c_str());
        }
        ImGui::EndGroup();
        if (ImGui::IsItemClicked(ImGuiMouseButton_Left)) showPort(pinned[i]);
        if (ImGui::IsItemClicked(ImGuiMouseButton_Right)) gone = i;
    }
    if (gone) pinned.erase(pinned.begin() + static_cast<std::ptrdiff_t>(*gone));
}

void Viewport::drawPicture(Picture& picture, ImVec2 low, ImVec2 high, float from, float to) {
    if (!picture.texture || picture.image.empty()) return;
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float width = high.x - low.x;
    list->AddImage(textureId(picture.texture), {low.x + width * from, low.y}, {low.x + width * to, high.y},
                   {from, 0}, {to, 1});
    const std::string name =
        (heldStill_ && &picture == &second_ ? "held: " : "") +
        (picture.title.empty() ? picture.port.text() : picture.title) +
        (picture.whyNot.empty() ? "" : " (the last good picture: " + picture.whyNot + ")");
    const ImVec2 at(low.x + width * from + 4, low.y + 3);
    list->AddText({at.x + 1, at.y + 1}, IM_COL32(0, 0, 0, 255), name.c_str());
    list->AddText(at, IM_COL32_WHITE, name.c_str());
}

void Viewport::inspector() {
    const Image& image = first_.image;
    if (!pixel_ || image.empty()) {
        ImGui::TextWrapped("a pixel's values: point at it; right click holds it");
        return;
    }
    int place[] = {std::min(pixel_->first, image.width - 1), std::min(pixel_->second, image.height - 1)};
    ImGui::PushItemWidth(ImGui::GetFontSize() * 8);
    if (ImGui::InputInt2("##pixel", place)) {
        held_ = true;
        pixel_ = {std::clamp(place[0], 0, image.width - 1), std::clamp(place[1], 0, image.height - 1)};
    }
    ImGui::PopItemWidth();
    ImGui::SameLine();
    std::string values = pixelText(image, place[0], place[1]);
    std::replace(values.begin(), values.end(), '\n', ' ');
    if (layout != Layout::One && image.sameSize(second_.image)) {
        std::string other = pixelText(second_.image, place[0], place[1]);
        std::replace(other.begin(), other.end(), '\n', ' ');
        values += "   |   " + other;
    }
    ImGui::TextWrapped("%s", values.c_str());
    ImGui::TextUnformatted(neighboursText(image, place[0], place[1], 0).c_str());
}

} // namespace kestrel::edit
