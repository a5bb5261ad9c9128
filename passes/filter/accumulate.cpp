#include "accumulate.h"
#include "execute/commands.h"
#include <fmt/format.h>

namespace kestrel {
namespace {

Format meanFormat(Format signal) {
    switch (formatInfo(signal).channels) {
    case 1:
        return Format::R32F;
    case 2:
        return Format::RG32F;
    default:
        return Format::RGBA32F;
    }
}

} // namespace

PassType Accumulate::type() {
    return Describe<Accumulate>(
               "Accumulate", "Mean of a signal over all frames since something other than the frame changed")
        .input("signal", PortKind::Texture, "What is averaged")
        .optionalInput("weight", PortKind::Texture,
                       "How much each pixel of this frame counts; without it all count alike")
        .carries({.channels = 1})
        .sameExtentAs("signal")
        .output("result", PortKind::Texture, "The mean")
        .internal("total", PortKind::Texture, "Sum of the weights")
        .number("maximum", &Accumulate::maximum, 0, 1e6, "frames",
                "From this many frames on the mean forgets exponentially; 0: never");
}

Declaration Accumulate::declare(const World&, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Inputs::Input& signal = inputs["signal"];
    const FormatInfo& format = formatInfo(signal.desc.format);
    if (format.integer || format.depth)
        declaration.problems.push_back(
            {"signal", fmt::format("cannot be averaged: it is {}", describe(signal.desc))});

    Output result{.port = "result",
                  .desc =
                      Desc::texture2D(meanFormat(signal.desc.format), signal.desc.extent, signal.desc.view)};
    if (signal.constant) { // the mean of a constant is the constant
        result.constant = signal.constant;
        declaration.outputs.push_back(std::move(result));
        declaration.leftOut.push_back({"averaging", "the signal is the same everywhere and always"});
        return declaration;
    }
    result.keeps = true;
    const bool weighted = inputs.connected("weight") && !inputs["weight"].constant;
    Step step{.name = "add",
              .shaders = {"filter/accumulate.comp"},
              .defines = {{"MEAN_FORMAT", std::string(formatInfo(result.desc.format).name)},
                          {"SIGNAL_FORMAT", std::string(format.name)}},
              .uses = {{.port = "signal", .access = Access::Image},
                       {.port = "result", .access = Access::Image, .write = true}},
              .group = "accumulation"};
    if (weighted) {
        step.defines.emplace("WEIGHTED", "1");
        step.defines["WEIGHT_FORMAT"] = std::string(formatInfo(inputs["weight"].desc.format).name);
        step.uses.push_back({.port = "weight", .access = Access::Image});
        step.uses.push_back({.port = "total", .access = Access::Image, .write = true});
        Output total{.port = "total",
                     .desc = Desc::texture2D(Format::R32F, signal.desc.extent, signal.desc.view)};
        total.keeps = true;
        declaration.outputs.push_back(std::move(total));
    } else if (inputs.connected("weight")) {
        declaration.leftOut.push_back({"weights", "they are the same everywhere"});
    }
    declaration.outputs.push_back(std::move(result));
    declaration.steps.push_back(std::move(step));
    declaration.depends = Causes::Properties;
    return declaration;
}

void Accumulate::execute(const Step& step, Commands& commands) {
    if (any(commands.causes() & ~Causes::Frame)) frames_ = 0;
    const bool full = maximum > 0 && frames_ >= static_cast<std::uint32_t>(maximum);
    if (!full) ++frames_;
    commands.set("count", static_cast<float>(frames_));
    // A full mean of n samples of like weight gives the new one 1/n if the old ones are scaled by (n - 1)/n.
    if (step.defines.contains("WEIGHTED"))
        commands.set("keep", full ? static_cast<float>(frames_ - 1) / static_cast<float>(frames_) : 1.0f);
    commands.dispatchOver(commands.desc("result").extent);
}

} // namespace kestrel
