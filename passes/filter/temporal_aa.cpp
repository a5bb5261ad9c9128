#include "temporal_aa.h"
#include "execute/commands.h"
#include <fmt/format.h>

namespace kestrel {

PassType TemporalAa::type() {
    return Describe<TemporalAa>(
               "TemporalAA",
               "Turns frames of a jittered G-buffer into a supersampled picture, followed over motion")
        .input("colour", PortKind::Texture,
               "What is anti-aliased: one sample a pixel, at the jittered position")
        .input("depth", PortKind::Texture, "Reversed depth of the surfaces")
        .carries(content::depth)
        .sameExtentAs("colour")
        .optionalInput(
            "motion", PortKind::Texture,
            "From each pixel to where its surface was in the last frame, in pixels; without it everything "
            "stays where it is")
        .carries(content::motion)
        .sameExtentAs("colour")
        .output("result", PortKind::Texture, "The anti-aliased picture")
        .internal("past", PortKind::Texture,
                  "Depth, frames without motion or change of depth, frames in the mean")
        .number("feedback", &TemporalAa::feedback, 0, 0.999, "", "Weight of the history")
        .number("gamma", &TemporalAa::gamma, 0, 1e3, "deviations",
                "The history is clipped to the mean of the 3 x 3 pixels around and so many deviations")
        .number("gamma_still", &TemporalAa::gammaStill, 0, 1e3, "deviations",
                "The same where nothing has moved for some frames: larger converges better, smaller follows "
                "changes of "
                "light faster")
        .flag("tame", &TemporalAa::tame,
              "Averages colour / (1 + luma), so that single bright samples do not flicker; no longer the "
              "mean of light");
}

Declaration TemporalAa::declare(const World&, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Inputs::Input& colour = inputs["colour"];
    const FormatInfo& format = formatInfo(colour.desc.format);
    if (format.integer || format.depth || format.channels == 2)
        declaration.problems.push_back(
            {"colour", fmt::format("cannot be anti-aliased: it is {}; one channel or colour is needed",
                                   describe(colour.desc))});

    // On the grid without jitter: whoever reads the result reads it with the unjittered view.
    View view = colour.desc.view;
    view.jitter = false;
    const Format made = format.channels == 1 ? Format::R32F : Format::RGBA32F;
    Output result{.port = "result", .desc = Desc::texture2D(made, colour.desc.extent, view)};
    if (colour.constant) {
        result.constant = colour.constant;
        declaration.outputs.push_back(std::move(result));
        declaration.leftOut.push_back({"anti-aliasing", "the colour is the same everywhere and always"});
        return declaration;
    }
    result.keeps = true;
    declaration.outputs.push_back(result);
    declaration.outputs.push_back(
        {.port = "past", .desc = Desc::texture2D(Format::RGBA32F, colour.desc.extent, view), .keeps = true});
    const bool moves = inputs.connected("motion") && inputs["motion"].constant != glm::vec4(0);
    Step step{.name = "resolve",
              .shaders = {"filter/temporal_aa.comp"},
              .defines = {{"COLOUR_FORMAT", std::string(format.name)},
                          {"RESULT_FORMAT", std::string(formatInfo(made).name)}},
              .uses = {{.port = "colour", .access = Access::Image},
                       {.port = "depth", .access = Access::Fetch},
                       {.port = "result", .access = Access::Image, .previous = true},
                       {.port = "result", .access = Access::Image, .write = true},
                       {.port = "past", .access = Access::Image, .previous = true},
                       {.port = "past", .access = Access::Image, .write = true}},
              .group = "filter"};
    if (tame) step.defines.emplace("TAME", "1");
    if (moves) {
        step.defines.emplace("MOTION", "1");
        step.uses.push_back({.port = "motion", .access = Access::Fetch});
    } else {
        declaration.leftOut.push_back({"reprojection", inputs.connected("motion")
                                                           ? "nothing in view moves"
                                                           : "no motion is connected"});
    }
    declaration.steps.push_back(std::move(step));
    declaration.depends = Causes::Properties | Causes::Cut | Causes::Size;
    declaration.always = true;
    return declaration;
}

void TemporalAa::execute(const Step&, Commands& commands) {
    const bool restart = any(commands.causes() & (Causes::Cut | Causes::Size | Causes::Properties));
    commands.set("restart", restart ? 1 : 0);
    commands.set("feedback", feedback);
    commands.set("gamma", gamma);
    commands.set("gammaStill", gammaStill);
    commands.dispatchOver(commands.desc("result").extent);
}

} // namespace kestrel
