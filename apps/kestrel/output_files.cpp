#include "output_files.h"
#include "core/files.h"
#include "image/io.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel {

namespace {

bool isRaw(const std::filesystem::path& file) { return file.extension() == ".bin"; }

const PortInfo* portInfo(const Renderer& renderer, const Registry& registry, const PortRef& port) {
    const GraphPass* pass = renderer.graph().find(port.pass);
    const PassType* type = pass != nullptr ? registry.find(pass->type) : nullptr;
    return type != nullptr ? type->port(port.port) : nullptr;
}

int layerCount(const Desc& desc) {
    return desc.kind == ResourceKind::TextureCube ? 6 : static_cast<int>(desc.extent.depth);
}

Image readLayers(Renderer& renderer, const PortRef& port, const Desc& desc) {
    const int layers = layerCount(desc);
    Image first = renderer.read(port);
    if (layers == 1) return first;
    if (first.height > maxImageSide / layers)
        throw InputError(fmt::format("{} has {} layers of {}: too much for one image", port.text(), layers,
                                     first.sizeText()));
    Image all(first.width, first.height * layers, first.channels);
    for (int layer = 0; layer < layers; ++layer) {
        const Image image = layer == 0 ? std::move(first) : renderer.read(port, layer);
        std::ranges::copy(image.values, all.values.begin() +
                                            static_cast<std::ptrdiff_t>(all.index(0, layer * image.height)));
    }
    return all;
}

std::vector<std::byte> encoded(const Image& image, ImageFormat format, bool display) {
    if (format != ImageFormat::Png) return encodeImage(image, format, Encoding::Linear);
    const bool colour = image.channels >= 3;
    return encodeImage(colour ? convertChannels(image, 3) : image, format,
                       colour && !display ? Encoding::Srgb : Encoding::Linear);
}

} // namespace

OutputFile parseOutput(const std::string& text) {
    const size_t equals = text.find('=');
    const auto port = parsePortRef(text.substr(0, equals));
    if (equals == std::string::npos || equals + 1 == text.size() || !port)
        throw InputError(fmt::format("--output {}: it must be of the form pass.port=FILE", text));
    const std::filesystem::path file = text.substr(equals + 1);
    if (!isRaw(file)) static_cast<void>(imageFormat(file));
    return {*port, file};
}

void addOutput(FileBytes& files, Renderer& renderer, const Registry& registry, const OutputFile& output) {
    if (isRaw(output.file)) {
        files.emplace_back(output.file, renderer.readBytes(output.port));
        return;
    }
    const PortInfo* info = portInfo(renderer, registry, output.port);
    const Image image = readLayers(renderer, output.port, renderer.desc(output.port));
    files.emplace_back(output.file, encoded(image, imageFormat(output.file),
                                            info != nullptr && info->content.space == Space::Display));
}

void addGraphOutputs(FileBytes& files, Renderer& renderer, const Registry& registry,
                     const std::filesystem::path& folder) {
    for (const PlanOutput& output : renderer.plan().outputs) {
        if (output.preview || output.resource < 0) continue;
        const std::filesystem::path file = folder / output.port.text();
        const auto named = [&](const char* ending) {
            std::filesystem::path full = file;
            full += ending;
            return full;
        };
        const Desc& desc = renderer.desc(output.port);
        if (desc.kind == ResourceKind::Buffer) {
            addOutput(files, renderer, registry, {output.port, named(".bin")});
            continue;
        }
        const PortInfo* info = portInfo(renderer, registry, output.port);
        const Image image = readLayers(renderer, output.port, desc);
        files.emplace_back(named(".png"), encoded(image, ImageFormat::Png,
                                                  info != nullptr && info->content.space == Space::Display));
        const bool cutOff = std::ranges::any_of(image.values, [](float v) { return !(v >= 0 && v <= 1); });
        if (cutOff) files.emplace_back(named(".exr"), encoded(image, ImageFormat::Exr, false));
    }
}

void writeAll(const FileBytes& files) {
    std::vector<std::filesystem::path> written;
    try {
        for (const auto& [file, bytes] : files) {
            writeFile(file, bytes);
            written.push_back(file);
        }
    } catch (...) {
        std::error_code ignored;
        for (const std::filesystem::path& file : written) std::filesystem::remove(file, ignored);
        throw;
    }
}

} // namespace kestrel
