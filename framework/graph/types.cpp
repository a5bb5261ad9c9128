#include "graph/types.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <limits>

namespace kestrel {
std::string bytesText(std::uint64_t bytes) {
    constexpr std::array units = {"bytes", "KiB", "MiB", "GiB"};
    size_t unit = 0;
    double amount = static_cast<double>(bytes);
    while (amount >= 1024 && unit + 1 < units.size()) {
        amount /= 1024;
        ++unit;
    }
    return fmt::format("{:.4g} {}", amount, units[unit]);
}

std::string_view portKindName(PortKind kind) {
    constexpr std::array<std::string_view, 6> names = {"texture", "buffer", "tracer",
                                                       "hits",    "layers", "radiance"};
    return names.at(static_cast<size_t>(kind));
}

std::string_view accessName(Access access) {
    constexpr std::array<std::string_view, 9> names = {
        "fetch", "image", "storage", "uniform", "attachment", "vertex", "indirect", "copy", "host"};
    return names.at(static_cast<size_t>(access));
}

Capabilities Capabilities::unlimited() {
    Capabilities all;
    constexpr int most = std::numeric_limits<int>::max();
    all.maxComputeImages = all.maxStorageBlocks = all.maxTextureUnits = all.maxUniformBlocks = most;
    all.maxTextureSize = all.max3DTextureSize = all.maxArrayLayers = most;
    all.maxComputeSharedBytes = all.maxComputeInvocations = most;
    all.maxTextureBufferTexels = all.maxStorageBlockBytes = std::numeric_limits<std::int64_t>::max();
    all.everyExtension = true;
    return all;
}

Desc Desc::texture2D(Format format, Extent extent, View view) {
    Desc desc;
    desc.format = format;
    desc.extent = {extent.width, extent.height, 1};
    desc.view = std::move(view);
    return desc;
}

Desc Desc::texture3D(Format format, Extent extent, int mips) {
    Desc desc;
    desc.kind = ResourceKind::Texture3D;
    desc.format = format;
    desc.extent = extent;
    desc.mips = mips;
    return desc;
}

Desc Desc::array2D(Format format, Extent extent) {
    Desc desc;
    desc.kind = ResourceKind::Texture2DArray;
    desc.format = format;
    desc.extent = extent;
    return desc;
}

Desc Desc::buffer(std::uint64_t bytes, Format texel) {
    Desc desc;
    desc.kind = ResourceKind::Buffer;
    desc.format = texel;
    desc.bytes = bytes;
    return desc;
}

Desc Desc::module(Bits provides, Bits required) {
    Desc desc;
    desc.kind = ResourceKind::Module;
    desc.provides = provides;
    desc.required = required;
    return desc;
}

Desc Desc::layersModule(const DepthLayers& layers, const View& view, Bits provides) {
    Desc desc = module(provides);
    desc.depthLayers = layers;
    desc.view = view;
    return desc;
}

std::uint64_t Desc::totalBytes() const {
    if (kind == ResourceKind::Module) return 0;
    if (kind == ResourceKind::Buffer) return bytes;
    std::uint64_t texels = 0;
    for (int mip = 0; mip < mips; ++mip) {
        const auto halved = [mip](std::uint32_t size) {
            return std::uint64_t{std::max(size >> std::min(mip, 31), 1U)};
        };
        const std::uint64_t slices =
            kind == ResourceKind::Texture3D ? halved(extent.depth) : std::uint64_t{extent.depth};
        texels += halved(extent.width) * halved(extent.height) * slices;
    }
    if (kind == ResourceKind::TextureCube) texels *= 6;
    return texels * static_cast<std::uint64_t>(formatInfo(format).bytes);
}

int Desc::layers(int mip) const {
    if (kind == ResourceKind::TextureCube) return 6;
    if (kind == ResourceKind::Texture2DArray) return static_cast<int>(extent.depth);
    if (kind != ResourceKind::Texture3D) return 1;
    return static_cast<int>(std::max(extent.depth >> std::clamp(mip, 0, 31), 1U));
}

Causes causesOf(const View& view) {
    Causes causes = view.jitter ? Causes::Frame : Causes::None;
    if (std::holds_alternative<FrameView>(view.source)) return Causes::None;
    if (std::holds_alternative<CameraView>(view.source)) causes |= Causes::Cameras;
    if (std::holds_alternative<LightView>(view.source)) causes |= Causes::Lights;
    if (const auto* cube = std::get_if<CubeView>(&view.source); cube != nullptr && !cube->point)
        causes |= Causes::Camera | Causes::Cut;
    return causes;
}

Extent sizeOf(const View& view, const Extent& frame) {
    int side = -1;
    if (const auto* of = std::get_if<CubeView>(&view.source)) side = of->side;
    if (const auto* of = std::get_if<LightView>(&view.source)) side = of->side;
    if (side < 0) return frame;
    const std::uint32_t pixels = side > 0 ? static_cast<std::uint32_t>(side) : frame.height;
    return {pixels, pixels, 1};
}

namespace {

std::string sideText(int side) { return side > 0 ? fmt::format(", {} pixels a side", side) : ""; }

} // namespace

std::string describe(const View& view) {
    if (const auto* of = std::get_if<CameraView>(&view.source))
        return of->name.empty() ? fmt::format("camera {}", of->camera) : fmt::format("camera '{}'", of->name);
    if (const auto* of = std::get_if<CubeView>(&view.source)) {
        const std::string about = of->point
                                      ? fmt::format("({}, {}, {})", of->point->x, of->point->y, of->point->z)
                                      : std::string("the eye");
        const std::string reach = of->farPlane > 0 ? fmt::format("{}", of->farPlane) : "infinity";
        return fmt::format("cube face {} about {}, from {} to {}{}", of->face, about, of->nearPlane, reach,
                           sideText(of->side));
    }
    if (const auto* of = std::get_if<LightView>(&view.source))
        return fmt::format("light {}, face {}{}", of->light, of->face, sideText(of->side));
    return {};
}

std::string describe(const Desc& desc) {
    if (const std::string seen = describe(desc.view); !seen.empty()) {
        Desc frames = desc;
        frames.view = {};
        return fmt::format("{} seen by {}", describe(frames), seen);
    }
    const std::string_view format = formatInfo(desc.format).name;
    const std::string mips = desc.mips > 1 ? fmt::format(", {} mips", desc.mips) : std::string();
    const Extent& e = desc.extent;
    switch (desc.kind) {
    case ResourceKind::Module:
        if (desc.depthLayers.count == 0) return "module";
        return fmt::format("module of {} depth layer{}{}", desc.depthLayers.count,
                           desc.depthLayers.count == 1 ? "" : "s",
                           desc.depthLayers.ordered ? " in order" : "");
    case ResourceKind::Buffer:
        return desc.format == Format::None ? fmt::format("buffer {}", bytesText(desc.bytes))
                                           : fmt::format("{} buffer {}", format, bytesText(desc.bytes));
    case ResourceKind::Texture2D:
        return fmt::format("{} {}x{}{}", format, e.width, e.height, mips);
    case ResourceKind::Texture2DArray:
        return fmt::format("{} {}x{}, {} layers{}", format, e.width, e.height, e.depth, mips);
    case ResourceKind::TextureCube:
        return fmt::format("{} cube {}x{}{}", format, e.width, e.height, mips);
    case ResourceKind::Texture3D:
        return fmt::format("{} {}x{}x{}{}", format, e.width, e.height, e.depth, mips);
    }
    return "unknown";
}

} // namespace kestrel
