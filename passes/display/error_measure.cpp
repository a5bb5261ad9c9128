#include "error_measure.h"
#include "execute/commands.h"
#include "image/colormap.h"
#include "image/error_figures.h"
#include <algorithm>

namespace kestrel {
namespace {

// One where `depth` holds a surface: view-space depth and coverage are 0 where nothing is.
Image maskOf(Image depth) {
    for (float& value : depth.values) value = value > 0 ? 1.0f : 0.0f;
    return depth;
}

bool hasGeometry(const Image& mask) {
    for (float value : mask.values)
        if (value > 0.5f) return true;
    return false;
}

} // namespace

PassType ErrorMeasure::type() {
    return Describe<ErrorMeasure>(
               "ErrorMeasure",
               "Measures an image against another: MSE, PSNR, SSIM, FLIP, and the FLIP heat map")
        .input("reference", PortKind::Texture, "What is right")
        .sameExtentAs("test")
        .input("test", PortKind::Texture, "What is measured")
        .optionalInput("mask", PortKind::Texture,
                       "Pixels above 0 count (coverage, view-space depth); without it all do")
        .carries({.channels = 1})
        .sameExtentAs("test")
        .displayOutput("heat_map", "FLIP error in the published colour map")
        .number("interval", &ErrorMeasure::interval, 1, 1e6, "frames",
                "Measures every so many frames; comparing takes the CPU longer than a frame")
        .choice("range", &ErrorMeasure::range, {"low", "high"},
                "low: code values in [0, 1]; high: linear light of any range");
}

Declaration ErrorMeasure::declare(const World&, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Desc& test = inputs["test"].desc;
    declaration.outputs.push_back(
        {.port = "heat_map", .desc = Desc::texture2D(Format::RGBA8, test.extent, test.view)});
    declaration.outputs.back().keeps = true; // between measurements the last one is seen
    Step step{.name = "measure",
              .uses = {{.port = "reference", .access = Access::Host},
                       {.port = "test", .access = Access::Host},
                       {.port = "heat_map", .access = Access::Copy, .write = true}},
              .group = "measuring"};
    if (inputs.connected("mask")) step.uses.push_back({.port = "mask", .access = Access::Host});
    declaration.steps.push_back(std::move(step));
    declaration.depends = Causes::Properties;
    return declaration;
}

void ErrorMeasure::execute(const Step& step, Commands& commands) {
    if (any(commands.causes() & ~Causes::Frame)) {
        runs_ = 0;
        commands.clear("heat_map", glm::vec4(0)); // what was measured is no more
    }
    if (++runs_ % static_cast<std::uint32_t>(interval) != 0) return;
    Image reference = commands.downloadImage("reference");
    Image test = commands.downloadImage("test");
    const int channels = std::min({reference.channels, test.channels, 3});
    reference = convertChannels(reference, channels);
    test = convertChannels(test, channels);
    Image mask;
    for (const Use& use : step.uses)
        if (use.port == "mask") mask = maskOf(convertChannels(commands.downloadImage("mask"), 1));
    if (!mask.empty() && !hasGeometry(mask)) return; // nothing in view, nothing to measure
    ErrorOptions options;
    options.hdr = range == Range::High;
    options.mask = mask.empty() ? nullptr : &mask;
    Image errors;
    const ErrorFigures figures = measureError(reference, test, options, &errors);
    commands.report("mse", figures.mse);
    commands.report("psnr", figures.psnr);
    commands.report("ssim", figures.ssim);
    commands.report("flip", figures.flip.mean);
    commands.uploadImage("heat_map", convertChannels(heatMap(errors), 4));
}

} // namespace kestrel
