#include "bilateral_blur.h"
#include "execute/commands.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel {

PassType BilateralBlur::type() {
    return Describe<BilateralBlur>("BilateralBlur", "Separable blur that stops at edges of depth")
        .input("signal", PortKind::Texture, "What is blurred")
        .input("view_depth", PortKind::Texture,
               "Distance along the view axis, with a guard band or without; 0 where nothing is")
        .carries(content::viewDepth)
        .output("result", PortKind::Texture, "The blurred signal; as it was where nothing is")
        .internal("blurred_x", PortKind::Texture, "Blurred along x")
        .number("radius", &BilateralBlur::radius, 0, 32, "pixels",
                "Taps to each side; the Gaussian's deviation is (radius + 1) / 2")
        .number("sharpness", &BilateralBlur::sharpness, 0, 1e6, "",
                "How fast the weight falls with the relative difference of depth")
        .flag("slope", &BilateralBlur::slope,
              "Expects the depth to go on with its slope, so that tilted planes are blurred too");
}

Declaration BilateralBlur::declare(const World&, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Inputs::Input& signal = inputs["signal"];
    const FormatInfo& format = formatInfo(signal.desc.format);
    if (format.integer || format.depth)
        declaration.problems.push_back(
            {"signal", fmt::format("cannot be blurred: it is {}", describe(signal.desc))});
    // A guard band of the depth that the signal has not lies around it.
    const Desc& depth = inputs["view_depth"].desc;
    const int band = (depth.view.guard - signal.desc.view.guard) / std::max(1, depth.view.divisor);
    const auto side = [&](std::uint32_t length) { return length + 2 * static_cast<std::uint32_t>(band); };
    if (band < 0 || depth.view.divisor != signal.desc.view.divisor ||
        depth.extent != Extent{side(signal.desc.extent.width), side(signal.desc.extent.height), 1})
        declaration.problems.push_back(
            {"view_depth", fmt::format("is {} but signal is {}", describe(depth), describe(signal.desc))});
    Output result{.port = "result", .desc = signal.desc};
    if (signal.constant || radius == 0 || inputs["view_depth"].constant) {
        // A constant stays itself, and a radius of 0 changes nothing: the result is the signal, without a
        // copy.
        result.same = "signal";
        declaration.outputs.push_back(std::move(result));
        declaration.leftOut.push_back({"blurring", radius == 0       ? "its radius is 0"
                                                   : signal.constant ? "the signal is the same everywhere"
                                                                     : "there is nothing in view"});
        return declaration;
    }
    declaration.outputs.push_back(result);
    declaration.outputs.push_back({.port = "blurred_x", .desc = signal.desc});
    const auto direction = [&](const char* name, const char* from, const char* to, const char* axis) {
        Step step{.name = name,
                  .shaders = {"filter/bilateral_blur.comp"},
                  .defines = {{"AXIS", axis},
                              {"SOURCE", from},
                              {"TARGET", to},
                              {"RADIUS", std::to_string(radius)},
                              {"BAND", std::to_string(std::max(0, band))},
                              {"SIGNAL_FORMAT", std::string(format.name)},
                              {"DEPTH_FORMAT", std::string(formatInfo(depth.format).name)}},
                  .uses = {{.port = from, .access = Access::Image},
                           {.port = "view_depth", .access = Access::Image},
                           {.port = to, .access = Access::Image, .write = true}},
                  .group = "filter"};
        if (slope) step.defines.emplace("SLOPE", "1");
        declaration.steps.push_back(std::move(step));
    };
    direction("horizontal", "signal", "blurred_x", "ivec2(1, 0)");
    direction("vertical", "blurred_x", "result", "ivec2(0, 1)");
    declaration.depends = Causes::Properties;
    return declaration;
}

void BilateralBlur::execute(const Step&, Commands& commands) {
    commands.set("sharpness", sharpness);
    commands.dispatchOver(commands.desc("result").extent);
}

} // namespace kestrel
