#include "tone_map.h"
#include "core/check.h"
#include "execute/commands.h"
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace kestrel {
namespace {

// Pixels of a column that one invocation adds up: the sum of their logarithms fits 32 bits.
constexpr std::uint32_t meterRows = 64;
constexpr Causes newStart = Causes::Cut | Causes::Size | Causes::Properties;

std::uint32_t stripsOf(const Extent& extent) {
    return extent.width * ((extent.height + meterRows - 1) / meterRows);
}

// The block of tone_map_adapt.comp.
struct Metered {
    float average, factor;
    std::uint32_t seen, pixels;
};

} // namespace

PassType ToneMap::type() {
    return Describe<ToneMap>("ToneMap", "Maps light to what a display shows")
        .input("colour", PortKind::Texture, "Linear light; one channel is grey")
        .displayOutput("image", "sRGB code values in [0, 1]")
        .range(0, 1)
        .internal("sums", PortKind::Buffer, "Logarithms of luminance, added up")
        .internal("metered", PortKind::Buffer, "The exposure, from frame to frame")
        .choice("operator", &ToneMap::curve, {"linear", "reinhard", "aces"},
                "Clamped; luminance over one plus luminance (Reinhard et al. 2002); a fit of the ACES film "
                "curve (Narkowicz 2015)")
        .number("exposure", &ToneMap::exposure, -32, 32, "stops",
                "Light is multiplied by two to this power first")
        .flag("auto_exposure", &ToneMap::autoExposure,
              "Exposes by the picture itself: the mean of log luminance over the pixels that are not black "
              "becomes key (Reinhard et al. 2002), with exposure on top; pictures that are measured against "
              "each other need one exposure, so not this one")
        .number("key", &ToneMap::key, 0.001, 1, "", "Of auto_exposure: what the mean becomes")
        .number(
            "adaptation", &ToneMap::adaptation, 0, 1e6, "frames",
            "Of auto_exposure: in so many frames the exposure goes 63 % of its way, in stops, so that noise "
            "does not make it flicker; at once in the first frame and after a cut; 0: always at once")
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
              .run = &ToneMap::map,
              .shaders = {"display/tone_map.comp"},
              .defines = {{"COLOUR_FORMAT", std::string(format.name)},
                          {"OPERATOR", std::to_string(static_cast<int>(curve))}},
              .uses = {{.port = "colour", .access = Access::Image},
                       {.port = "image", .access = Access::Image, .write = true}},
              .group = "display"};
    if (format.channels == 1) step.defines.emplace("GREY", "1");
    if (encode) step.defines.emplace("ENCODE", "1");
    declaration.depends = Causes::Properties;
    if (autoExposure) {
        declareMetering(declaration, colour);
        step.defines.emplace("METERED", "1");
        step.uses.push_back({.port = "metered", .access = Access::Storage});
    }
    declaration.steps.push_back(std::move(step));
    return declaration;
}

void ToneMap::declareMetering(Declaration& declaration, const Desc& colour) const {
    const FormatInfo& format = formatInfo(colour.format);
    declaration.outputs.push_back(
        {.port = "sums",
         .desc = Desc::buffer(std::uint64_t{stripsOf(colour.extent)} * 2 * sizeof(std::uint32_t))});
    declaration.outputs.push_back({.port = "metered", .desc = Desc::buffer(sizeof(Metered)), .keeps = true});
    Step meter{
        .name = "meter",
        .run = &ToneMap::meter,
        .shaders = {"display/tone_map_meter.comp"},
        .defines = {{"COLOUR_FORMAT", std::string(format.name)}, {"METER_ROWS", std::to_string(meterRows)}},
        .uses = {{.port = "colour", .access = Access::Image},
                 {.port = "sums", .access = Access::Storage, .write = true}},
        .group = "display"};
    if (format.channels == 1) meter.defines.emplace("GREY", "1");
    declaration.steps.push_back(std::move(meter));
    declaration.steps.push_back({.name = "adapt",
                                 .run = &ToneMap::adapt,
                                 .shaders = {"display/tone_map_adapt.comp"},
                                 .uses = {{.port = "sums", .access = Access::Storage},
                                          {.port = "metered", .access = Access::Storage, .write = true}},
                                 .group = "display"});
    declaration.steps.push_back({.name = "report",
                                 .run = &ToneMap::report,
                                 .uses = {{.port = "metered", .access = Access::Host}},
                                 .group = "display"});
    declaration.depends = newStart;
    declaration.always = adaptation > 0; // the exposure goes on where the picture stands still
}

void ToneMap::adapt(Commands& commands) const {
    commands.set("strips", static_cast<int>(stripsOf(commands.desc("colour").extent)));
    commands.set("restart", any(commands.causes() & newStart) ? 1 : 0);
    commands.set("rate", adaptation > 0 ? 1 - std::exp(-1 / adaptation) : 1.0f);
    commands.set("key", key);
    commands.set("exposure", exposure);
    commands.dispatch(1);
}

void ToneMap::meter(Commands& commands) const {
    const Extent& extent = commands.desc("image").extent;
    commands.dispatchOver(extent.width, (extent.height + meterRows - 1) / meterRows);
}

void ToneMap::report(Commands& commands) const {
    Metered metered{};
    const std::vector<std::byte> bytes = commands.download("metered");
    KESTREL_CHECK_EQ(bytes.size(), sizeof(metered));
    std::memcpy(&metered, bytes.data(), sizeof(metered));
    commands.report("exposure", std::log2(double{metered.factor}));
    commands.report("pixels metered", metered.pixels);
}

void ToneMap::map(Commands& commands) const {
    if (!autoExposure) commands.set("exposure", std::exp2(exposure));
    commands.dispatchOver(commands.desc("image").extent);
}

} // namespace kestrel
