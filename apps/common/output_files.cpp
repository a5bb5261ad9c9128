#include "output_files.h"
#include "core/files.h"
#include "image/io.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel {

namespace {

using Kind = OutputFile::Kind;

// The kind by its name as "exr:-" has it, or by the file's ending. Throws InputError for another ending.
Kind kindOf(const std::filesystem::path& file) {
    if (file.extension() == ".bin") return Kind::Raw;
    switch (imageFormat(file)) {
    case ImageFormat::Png:
        return Kind::Png;
    case ImageFormat::Hdr:
        return Kind::Hdr;
    case ImageFormat::Exr:
        return Kind::Exr;
    }
    return Kind::Png;
}

ImageFormat formatOf(Kind kind) {
    return kind == Kind::Exr ? ImageFormat::Exr : kind == Kind::Hdr ? ImageFormat::Hdr : ImageFormat::Png;
}

// Walks over a file's name: `text` gets what stands there as it is, `number` the width of each frame number.
// False for a '%' that is neither.
template<class Text, class Number>
bool readPattern(const std::string& name, Text text, Number number) {
    for (size_t i = 0; i < name.size(); ++i) {
        if (name[i] != '%') {
            text(name[i]);
            continue;
        }
        if (++i < name.size() && name[i] == '%') {
            text('%');
            continue;
        }
        // "%d", "%3d" and "%03d": a file's name has no blanks, so both mean zeros in front.
        int width = 0;
        for (; i < name.size() && name[i] >= '0' && name[i] <= '9'; ++i) width = 10 * width + (name[i] - '0');
        if (i >= name.size() || name[i] != 'd' || width > 20) return false;
        number(width);
    }
    return true;
}

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

// The name with the frame's number in it.
std::filesystem::path withFrame(const std::filesystem::path& file, std::uint32_t frame) {
    std::string name;
    readPattern(
        file.filename().string(), [&](char c) { name += c; },
        [&](int width) { name += fmt::format("{:0{}}", frame, width); });
    return file.parent_path() / name;
}

} // namespace

OutputFile parseOutput(const std::string& text) {
    const size_t equals = text.find('=');
    const auto port = parsePortRef(text.substr(0, equals));
    if (equals == std::string::npos || equals + 1 == text.size() || !port)
        throw InputError(fmt::format("--output {}: it must be of the form pass.port=FILE", text));
    OutputFile output{*port, text.substr(equals + 1)};
    const std::string name = output.file.string();
    for (const auto& [word, kind] : {std::pair("png:-", Kind::Png), std::pair("hdr:-", Kind::Hdr),
                                     std::pair("exr:-", Kind::Exr), std::pair("bin:-", Kind::Raw)}) {
        if (name != word) continue;
        output.file = "-";
        output.kind = kind;
        return output;
    }
    if (isStream(output.file)) {
        if (output.file.has_extension()) output.kind = kindOf(output.file);
        return output;
    }
    output.kind = kindOf(output.file);
    int numbers = 0;
    if (!readPattern(
            output.file.filename().string(), [](char) {}, [&](int) { ++numbers; }) ||
        numbers > 1)
        throw InputError(
            fmt::format("--output {}: '%' begins the number of the frame, once, as in %d or %03d; "
                        "for the character itself write %%",
                        text));
    output.sequence = numbers == 1;
    if (!output.sequence) output.file = withFrame(output.file, 0); // "%%" is "%"
    return output;
}

std::filesystem::path fileOf(const OutputFile& output, std::uint32_t frame) {
    return output.sequence ? withFrame(output.file, frame) : output.file;
}

void addOutput(FileBytes& files, Renderer& renderer, const Registry& registry, const OutputFile& output) {
    const std::filesystem::path file = fileOf(output, renderer.last().index);
    if (output.kind == Kind::Raw) {
        files.emplace_back(file, renderer.readBytes(output.port));
        return;
    }
    const PortInfo* info = portInfo(renderer, registry, output.port);
    const Image image = readLayers(renderer, output.port, renderer.desc(output.port));
    files.emplace_back(file, encoded(image, formatOf(output.kind),
                                     info != nullptr && info->content.space == Space::Display));
}

void addGraphOutputs(FileBytes& files, Renderer& renderer, const Registry& registry,
                     const std::filesystem::path& folder, const std::string& mark) {
    for (const PlanOutput& output : renderer.plan().outputs) {
        if (output.preview || output.resource < 0) continue;
        const std::filesystem::path file = folder / output.port.text();
        const auto named = [&](const char* ending) {
            std::filesystem::path full = file;
            full += mark + ending;
            return full;
        };
        const Desc& desc = renderer.desc(output.port);
        if (desc.kind == ResourceKind::Buffer) {
            addOutput(files, renderer, registry, {output.port, named(".bin"), Kind::Raw});
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

} // namespace kestrel
