#include "image_file.h"
#include "core/error.h"
#include "execute/commands.h"
#include "image/io.h"
#include <fmt/format.h>

namespace kestrel {

PassType ImageFile::type() {
    PassType type =
        Describe<ImageFile>("Image", "A picture from a file: a captured buffer, another renderer's reference")
            .output(
                "image", PortKind::Texture,
                "The picture in its own size as 32-bit floats: one channel, two, or four with alpha 1 where "
                "the file has none. Who needs the frame's size refuses another, with both sizes")
            .text("file", &ImageFile::file,
                  "EXR, PNG or HDR, from the folder of the graph file; FILE.exr:LAYER names a layer")
            .choice(
                "values", &ImageFile::values, {"auto", "as_they_are", "from_srgb"},
                "from_srgb: colours of the file are sRGB code values and become linear light; auto: so of a "
                "PNG with colours, else as they are")
            .number("guard", &ImageFile::guard, 0, 512, "pixels",
                    "Width of the band around the frame that a captured buffer has on each side");
    type.properties.front().unit = "file"; // setProperties() puts the graph's folder in front
    return type;
}

std::shared_ptr<const ImageFile::Read> ImageFile::read() const {
    // The state is taken before the picture: a write in between shows as a change.
    const std::optional<FileState> state = fileState(imageName(file).file);
    if (read_ && read_->name == file && read_->values == values && read_->state == state) return read_;
    Picture picture = readPicture(file);
    const bool colour = picture.image.channels >= 3;
    if (colour &&
        (values == Values::FromSrgb || (values == Values::Auto && picture.format == ImageFormat::Png)))
        picture.image = srgbToLinear(std::move(picture.image));
    if (colour) picture.image = convertChannels(picture.image, 4);
    read_ = std::make_shared<const Read>(Read{file, values, state, std::move(picture.image)});
    return read_;
}

Declaration ImageFile::declare(const World& world, const Inputs&, const Demand&) const {
    Declaration declaration;
    Output output{.port = "image", .desc = Desc::texture2D(Format::RGBA32F, {1, 1, 1})};
    const auto refuse = [&](const std::string& message) {
        output.constant = glm::vec4(0);
        declaration.outputs.push_back(output);
        declaration.problems.push_back({"file", message});
        return declaration;
    };
    if (file.empty()) return refuse("names no file");
    std::shared_ptr<const Read> held;
    try {
        held = read();
        const Image& image = held->image;
        const Extent extent{static_cast<std::uint32_t>(image.width), static_cast<std::uint32_t>(image.height),
                            1};
        const int most = world.capabilities.maxTextureSize;
        if (image.width > most || image.height > most)
            return refuse(fmt::format("{} is {}; this machine's textures have at most {} a side", file,
                                      image.sizeText(), most));
        output.desc = Desc::texture2D(image.channels == 1   ? Format::R32F
                                      : image.channels == 2 ? Format::RG32F
                                                            : Format::RGBA32F,
                                      extent, {.guard = guard});
    } catch (const InputError& error) {
        return refuse(error.problems().front().text());
    }
    declaration.outputs.push_back(output);
    declaration.steps.push_back(
        {.name = "upload",
         .run = [held](Commands& commands) { commands.uploadImage("image", held->image); },
         .uses = {{.port = "image", .access = Access::Copy, .write = true}},
         .group = "loading"});
    declaration.depends = Causes::Properties;
    return declaration;
}

} // namespace kestrel
