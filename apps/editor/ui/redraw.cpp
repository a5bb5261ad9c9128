#include "ui/redraw.h"
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace kestrel::edit {
namespace {

ImTextureID textureOf(const ImDrawCmd& command) {
#if IMGUI_VERSION_NUM >= 19200 // textures of its own have no name before they are drawn first
    return command.TexRef._TexData != nullptr ? command.TexRef._TexData->TexID : command.TexRef._TexID;
#else
    return command.TextureId;
#endif
}

// The pixels of a clip rectangle as ImGui's backend for OpenGL gives them to the scissor: whole numbers by
// cutting off, from the bottom.
PixelBox scissorOf(const ImVec4& clip, float height) {
    if (clip.z <= clip.x || clip.w <= clip.y) return {};
    const int left = static_cast<int>(clip.x), below = static_cast<int>(height - clip.w);
    const int bottom = static_cast<int>(height) - below;
    return {left, bottom - static_cast<int>(clip.w - clip.y), left + static_cast<int>(clip.z - clip.x),
            bottom};
}

PixelBox common(const PixelBox& a, const PixelBox& b) {
    return {std::max(a.left, b.left), std::max(a.top, b.top), std::min(a.right, b.right),
            std::min(a.bottom, b.bottom)};
}

PixelBox joined(const PixelBox& a, const PixelBox& b) {
    if (a.empty()) return b;
    if (b.empty()) return a;
    return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right),
            std::max(a.bottom, b.bottom)};
}

// Every pixel that a triangle may touch, with one more on each side for how its driver rounds.
PixelBox around(const ImVec2& a, const ImVec2& b, const ImVec2& c) {
    static constexpr float most = 1 << 20; // what lies farther out is on no screen
    const auto whole = [](float place) { return static_cast<int>(std::clamp(place, -most, most)); };
    return {whole(std::floor(std::min({a.x, b.x, c.x}))) - 1,
            whole(std::floor(std::min({a.y, b.y, c.y}))) - 1, whole(std::ceil(std::max({a.x, b.x, c.x}))) + 1,
            whole(std::ceil(std::max({a.y, b.y, c.y}))) + 1};
}

bool isSame(const ImVec4& a, const ImVec4& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

void joinOverlapping(std::vector<PixelBox>& boxes) {
    for (bool again = true; again;) {
        again = false;
        for (size_t i = 0; i < boxes.size(); ++i)
            for (size_t k = boxes.size() - 1; k > i; --k)
                if (boxes[i].overlaps(boxes[k])) {
                    boxes[i] = joined(boxes[i], boxes[k]);
                    boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(k));
                    again = true;
                }
    }
}

template<class T, class Held>
void keep(std::vector<T>& kept, const Held& held) {
    kept.assign(held.Data, held.Data + held.Size);
}

template<class T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

} // namespace

struct Redraw::Triangle {
    std::uint32_t corners[3];
    std::uint32_t command;
};

std::vector<Redraw::Triangle> Redraw::trianglesOf(const List& list) {
    std::vector<Triangle> triangles;
    triangles.reserve(list.indices.size() / 3);
    for (std::uint32_t i = 0; i < list.commands.size(); ++i) {
        const ImDrawCmd& command = list.commands[i];
        if (command.UserCallback != nullptr) continue;
        for (std::uint32_t k = 0; k + 2 < command.ElemCount; k += 3) {
            const ImDrawIdx* index = list.indices.data() + command.IdxOffset + k;
            triangles.push_back(
                {{index[0] + command.VtxOffset, index[1] + command.VtxOffset, index[2] + command.VtxOffset},
                 i});
        }
    }
    return triangles;
}

PixelBox Redraw::boundsOf(const List& list, const Triangle& triangle) {
    return around(list.vertices[triangle.corners[0]].pos, list.vertices[triangle.corners[1]].pos,
                  list.vertices[triangle.corners[2]].pos);
}

bool Redraw::same(const List& a, const Triangle& one, const List& b, const Triangle& other) {
    const ImDrawCmd &first = a.commands[one.command], &second = b.commands[other.command];
    if (!isSame(first.ClipRect, second.ClipRect) || textureOf(first) != textureOf(second)) return false;
    for (int i = 0; i < 3; ++i)
        if (std::memcmp(&a.vertices[one.corners[i]], &b.vertices[other.corners[i]], sizeof(ImDrawVert)) != 0)
            return false;
    return true;
}

// What lies between the triangles that both begin with and those that both end with.
void Redraw::addDifference(const List& before, const List& now, std::vector<PixelBox>& boxes) {
    const auto sameCommand = [](const ImDrawCmd& a, const ImDrawCmd& b) {
        return isSame(a.ClipRect, b.ClipRect) && textureOf(a) == textureOf(b) && a.VtxOffset == b.VtxOffset &&
               a.IdxOffset == b.IdxOffset && a.ElemCount == b.ElemCount && a.UserCallback == b.UserCallback;
    };
    if (sameBytes(before.vertices, now.vertices) && sameBytes(before.indices, now.indices) &&
        std::ranges::equal(before.commands, now.commands, sameCommand))
        return;
    const std::vector<Triangle> old = trianglesOf(before), fresh = trianglesOf(now);
    const size_t shorter = std::min(old.size(), fresh.size());
    size_t begin = 0, end = 0;
    while (begin < shorter && same(before, old[begin], now, fresh[begin])) ++begin;
    while (begin + end < shorter &&
           same(before, old[old.size() - 1 - end], now, fresh[fresh.size() - 1 - end]))
        ++end;
    PixelBox box;
    const auto add = [&](const List& list, const std::vector<Triangle>& triangles) {
        for (size_t i = begin; i + end < triangles.size(); ++i) {
            const ImVec4& clip = list.commands[triangles[i].command].ClipRect;
            const PixelBox seen = common(boundsOf(list, triangles[i]),
                                         around({clip.x, clip.y}, {clip.z, clip.w}, {clip.x, clip.w}));
            if (!seen.empty()) box = joined(box, seen);
        }
    };
    add(before, old);
    add(now, fresh);
    if (!box.empty()) boxes.push_back(box);
}

void Redraw::addWritten(const List& list, const std::vector<ImTextureID>& written,
                        std::vector<PixelBox>& boxes) {
    const auto shows = [&](const ImDrawCmd& command) {
        return command.UserCallback == nullptr &&
               std::ranges::find(written, textureOf(command)) != written.end();
    };
    if (std::ranges::none_of(list.commands, shows)) return;
    for (const Triangle& triangle : trianglesOf(list))
        if (shows(list.commands[triangle.command])) boxes.push_back(boundsOf(list, triangle));
}

std::vector<PixelBox> Redraw::changed(const ImDrawData& data, const std::vector<ImTextureID>& written) {
    std::swap(before_, now_);
    now_.resize(static_cast<size_t>(data.CmdListsCount));
    for (size_t i = 0; i < now_.size(); ++i) {
        const ImDrawList& list = *data.CmdLists[static_cast<int>(i)];
        now_[i].name = list._OwnerName != nullptr ? list._OwnerName : "";
        keep(now_[i].vertices, list.VtxBuffer);
        keep(now_[i].indices, list.IdxBuffer);
        keep(now_[i].commands, list.CmdBuffer);
    }
    const PixelBox all{0, 0, static_cast<int>(data.DisplaySize.x), static_cast<int>(data.DisplaySize.y)};
    const bool scaled = data.FramebufferScale.x != 1 || data.FramebufferScale.y != 1;
    const bool known = known_ && size_.x == data.DisplaySize.x && size_.y == data.DisplaySize.y && !scaled;
    size_ = data.DisplaySize;
    known_ = true;
    if (!known) return {all};

    // Windows that come, go or change places lie between those that both frames begin and end with.
    const size_t shorter = std::min(before_.size(), now_.size());
    size_t begin = 0, end = 0;
    while (begin < shorter && before_[begin].name == now_[begin].name) ++begin;
    while (begin + end < shorter &&
           before_[before_.size() - 1 - end].name == now_[now_.size() - 1 - end].name)
        ++end;
    std::vector<PixelBox> boxes;
    for (size_t i = 0; i < begin; ++i) addDifference(before_[i], now_[i], boxes);
    for (size_t i = 1; i <= end; ++i)
        addDifference(before_[before_.size() - i], now_[now_.size() - i], boxes);
    for (size_t i = begin; i + end < before_.size(); ++i) addDifference(before_[i], {}, boxes);
    for (size_t i = begin; i + end < now_.size(); ++i) addDifference({}, now_[i], boxes);
    if (!written.empty())
        for (const List& list : now_) addWritten(list, written, boxes);
    for (PixelBox& box : boxes) box = common(box, all);
    std::erase_if(boxes, [](const PixelBox& box) { return box.empty(); });
    joinOverlapping(boxes);
    return boxes;
}

void Redraw::limitTo(ImDrawData& data, const PixelBox& box) const {
    const float height = data.DisplaySize.y;
    const bool scaled = data.FramebufferScale.x != 1 || data.FramebufferScale.y != 1;
    if (scaled) return; // changed() says everything, once
    for (size_t i = 0; i < now_.size(); ++i) {
        const List& kept = now_[i];
        ImDrawList& list = *data.CmdLists[static_cast<int>(i)];
        list.CmdBuffer.resize(0);
        list.IdxBuffer.resize(0);
        for (const ImDrawCmd& command : kept.commands) {
            const PixelBox seen = common(scissorOf(command.ClipRect, height), box);
            if (command.UserCallback == nullptr && seen.empty()) continue;
            ImDrawCmd limited = command;
            limited.IdxOffset = static_cast<unsigned>(list.IdxBuffer.Size);
            limited.ClipRect = {static_cast<float>(seen.left), static_cast<float>(seen.top),
                                static_cast<float>(seen.right), static_cast<float>(seen.bottom)};
            const ImDrawIdx* index = kept.indices.data() + command.IdxOffset;
            const ImDrawVert* vertices = kept.vertices.data() + command.VtxOffset;
            for (const ImDrawIdx* last = index + command.ElemCount; index + 2 < last; index += 3)
                if (around(vertices[index[0]].pos, vertices[index[1]].pos, vertices[index[2]].pos)
                        .overlaps(box))
                    for (int k = 0; k < 3; ++k) list.IdxBuffer.push_back(index[k]);
            limited.ElemCount = static_cast<unsigned>(list.IdxBuffer.Size) - limited.IdxOffset;
            if (command.UserCallback != nullptr || limited.ElemCount > 0) list.CmdBuffer.push_back(limited);
        }
        // Of a list that is not seen nothing goes to the driver.
        list.VtxBuffer.Size = list.CmdBuffer.empty() ? 0 : static_cast<int>(kept.vertices.size());
    }
}

} // namespace kestrel::edit
