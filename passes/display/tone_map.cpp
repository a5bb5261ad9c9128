#include "tone_map.h"
#include "execute/commands.h"
#include <cmath>
#include <fmt/format.h>

namespace kestrel {

PassType ToneMap::type() {
    return Describe<ToneMap>("ToneMap", "Maps light to what a display shows")
        .input("colour", PortKind::Texture, "Linear light; one channel is grey")
        .displayOutput("image", "sRGB code values in [0, 1]")
        .choice("operator", &ToneMap::curve, {"linear", "reinhard", "aces"},
                "Clamped; luminance over one plus luminance (Reinhard et al. 2002); a fit of the ACES film "
                "curve (Narkowicz 2015)")
        .number("exposure", &ToneMap::exposure, -32, 32, "stops",
                "Light is multiplied by two to this power first")
        .flag("encode", &ToneMap::encode, "Applies the transfer curve of sRGB");
}

Declaration ToneMap::declare(const World&, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Desc& colour = inputs["colour"].desc;
    const FormatInfo& format = formatInfo(colour.format);
    if (format.integer || format.depth)
        declaration.problems.push_back({"colour", fmt::format("is no colour: it is {}", describe(colour))});
    declaration.outputs.push_back(
        {.port = "image", .desc = Desc::texture2D(Format::RGBA8, colour.extent, colour.view)});
    Step step{.name = "map",
              .shaders = {"display/tone_map.comp"},
              .defines = {{"COLOUR_FORMAT", std::string(format.name)},
                          {"OPERATOR", std::to_string(static_cast<int>(curve))}},
              .uses = {{.port = "colour", .access = Access::Image},
                       {.port = "image", .access = Access::Image, .write = true}},
              .modules = {},
              .group = "display"};
    if (format.channels == 1) step.defines.emplace("GREY", "1");
    if (encode) step.defines.emplace("ENCODE", "1");
    declaration.steps.push_back(std::move(step));
    declaration.depends = Causes::Properties;
    return declaration;
}

void ToneMap::execute(const Step&, Commands& commands) {
    commands.set("exposure", std::exp2(exposure));
    commands.dispatchOver(commands.desc("image").extent);
}

} // namespace kestrel
