#include "environment.h"
#include "core/error.h"
#include "core/files.h"
#include "execute/commands.h"
#include "image/io.h"
#include "shared/environment.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel {
namespace {

// The texture that pictures of any size are brought to.
constexpr Extent pictureExtent{1024, 512, 1};

// Averages where the picture is larger, repeats where it is smaller; no longer side than what is kept.
Image resampledPicture(const Image& picture) {
    const int width = static_cast<int>(pictureExtent.width), height = static_cast<int>(pictureExtent.height);
    Image result(width, height, 4, 1);
    const auto range = [](int i, int to, int from) {
        const int first = static_cast<int>(std::int64_t{i} * from / to);
        const int last = static_cast<int>((std::int64_t{i} + 1) * from / to);
        return std::pair(first, std::max(last, first + 1));
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto [left, right] = range(x, width, picture.width);
            const auto [top, bottom] = range(y, height, picture.height);
            for (int c = 0; c < 3; ++c) {
                double sum = 0;
                for (int v = top; v < bottom; ++v)
                    for (int u = left; u < right; ++u) {
                        const double value = double{picture.at(u, v, c)};
                        sum += value >= 0 ? std::min(value, 65504.0) : 0; // NaN and negative light: none
                    }
                result.at(x, y, c) = static_cast<float>(sum / ((right - left) * (bottom - top)));
            }
        }
    return result;
}

// A picture's path is relative to the scene's folder, or to the working folder of a built-in scene.
Image readSurroundings(const std::string& file, const Scene& scene) {
    if (file.empty()) throw InputError("Environment: its kind is picture, but no file is named");
    const std::filesystem::path source(scene.source);
    const bool builtin = scene.source.empty() || scene.source.starts_with("builtin:");
    const std::filesystem::path folder =
        builtin || source.parent_path().empty() ? std::filesystem::path(".") : source.parent_path();
    const Picture picture = readPicture(imageName(folder / file));
    if (picture.image.channels < 3 && picture.image.channels != 1)
        throw InputError(fmt::format("'{}' is no picture of the surroundings: it has {} channels", file,
                                     picture.image.channels));
    const Image colour = convertChannels(picture.image, 3);
    // An 8-bit picture holds code values.
    return resampledPicture(holdsHighDynamicRange(picture.format) ? colour : srgbToLinear(colour));
}

} // namespace

PassType Environment::type() {
    return Describe<Environment>("Environment", "Light from the surroundings, by direction")
        .optionalInput("depth", PortKind::Texture, "Reversed depth: the background shows where it is 0")
        .carries(content::depth)
        .output("radiance", PortKind::Radiance,
                "The surroundings where a ray meets nothing; surfaces give nothing")
        .output("background", PortKind::Texture,
                "The surroundings as the camera sees them where there is no surface, else 0; needs depth")
        .carries(content::colour)
        .internal("settings", PortKind::Buffer, "The properties, for shaders")
        .internal("picture", PortKind::Texture, "The image, latitude by longitude")
        .choice("kind", &Environment::kind, {"constant", "gradient", "picture"},
                "One colour, a gradient over the height, or an image file")
        .vector("colour", &Environment::colour, 0, 1e6, "radiance", "Of kind constant")
        .vector("zenith", &Environment::zenith, 0, 1e6, "radiance", "Of a gradient, straight up (+y)")
        .vector("horizon", &Environment::horizon, 0, 1e6, "radiance", "Of a gradient, level")
        .vector("ground", &Environment::ground, 0, 1e6, "radiance", "Of a gradient, below the horizon")
        .text(
            "file", &Environment::file,
            "Of kind picture: a PNG, HDR or EXR of all directions (longitude along x, zenith at the top; "
            "FILE.exr:LAYER names a layer), beside the scene's file, or in the working folder for a built-in "
            "scene")
        .number("intensity", &Environment::intensity, 0, 1e6, "", "Factor on all of it")
        .number("rotation", &Environment::rotation, -360, 360, "degrees",
                "Turns a picture about the vertical");
}

Defines Environment::defines() const {
    if (kind == Kind::Picture) return {{"PICTURE", "1"}};
    if (kind == Kind::Gradient) return {{"GRADIENT", "1"}};
    return {};
}

Declaration Environment::declare(const World&, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    Module module{.port = "radiance",
                  .shader = "lighting/environment.glsl",
                  .defines = defines(),
                  .uses = {{.port = "settings", .access = Access::Uniform}}};
    declaration.outputs = {{.port = "radiance", .desc = Desc::module(0)},
                           {.port = "settings", .desc = Desc::buffer(sizeof(shared::EnvironmentSettings))}};
    Step upload{.name = "settings",
                .run = &Environment::upload,
                .uses = {{.port = "settings", .access = Access::Copy, .write = true}}};
    if (kind == Kind::Picture) {
        declaration.outputs.push_back(
            {.port = "picture", .desc = Desc::texture2D(Format::RGBA16F, pictureExtent)});
        upload.uses.push_back({.port = "picture", .access = Access::Copy, .write = true});
        module.uses.push_back({.port = "picture", .access = Access::Fetch, .linear = true});
    } else {
        declaration.leftOut.push_back({"picture", "its kind is another"});
    }
    declaration.steps.push_back(std::move(upload));
    if (!inputs.connected("depth")) {
        declaration.leftOut.push_back({"background", "no depth is connected"});
    } else if (demand.reads("background")) {
        const Desc& depth = inputs["depth"].desc;
        declaration.outputs.push_back(
            {.port = "background", .desc = Desc::texture2D(Format::RGBA16F, depth.extent, depth.view)});
        Step step{.name = "background",
                  .run = [extent = depth.extent](Commands& commands) { commands.dispatchOver(extent); },
                  .shaders = {"lighting/background.comp"},
                  .defines = defines(),
                  .uses = {{.port = "depth", .access = Access::Fetch},
                           {.port = "settings", .access = Access::Uniform},
                           {.port = "background", .access = Access::Image, .write = true}}};
        if (kind == Kind::Picture)
            step.uses.push_back({.port = "picture", .access = Access::Fetch, .linear = true});
        declaration.steps.push_back(std::move(step));
        declaration.depends |= Causes::Camera | Causes::Cut;
    }
    declaration.modules.push_back(std::move(module));
    declaration.depends |= Causes::Properties;
    return declaration;
}

void Environment::upload(Commands& commands) const {
    const glm::vec3& level = kind == Kind::Constant ? colour : horizon;
    commands.uploadValue("settings",
                         shared::EnvironmentSettings{intensity * zenith, glm::radians(rotation),
                                                     intensity * level, intensity, intensity * ground, 0});
    if (kind == Kind::Picture) commands.uploadImage("picture", readSurroundings(file, commands.scene()));
}

} // namespace kestrel
