#include "spatiotemporal_filter.h"
#include "execute/commands.h"
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace kestrel {
namespace {

constexpr int gradientTile = 8; // pixels a side

std::string glslName(Format format) { return std::string(formatInfo(format).name); }

// The records that iteration `i` reads; two take turns.
std::string filteredPort(int i) { return i % 2 == 0 ? "filtered" : "filtered_again"; }
std::string filteredBlock(int i) { return i % 2 == 0 ? "Filtered" : "FilteredAgain"; }

// The block with the view that last frame's image of a port was made with.
std::string previousView(const std::string& port) {
    return port == "result"       ? "PreviousResultView"
           : port == "integrated" ? "PreviousIntegratedView"
                                  : "PreviousSmoothedOnceView";
}

} // namespace

struct SpatiotemporalFilter::Choices {
    bool past = false, motion = false, weighted = false, gradient = false, filteredHistory = false;
    bool historyLength = false, variance = false;
    bool texels =
        true; // records are read as texels: much faster on a CPU driver, but devices limit their number
    int iterations = 0;
    bool oneChannel = true;
    Format format = Format::R32F;    // of what is accumulated and of the result
    Format filtered = Format::RG32F; // with the variance beside
    std::string mean;                // what the temporal step writes
    std::string kept;                // what the next frame reads

    [[nodiscard]] Defines defines() const {
        Defines defines = {
            {"HISTORY_FORMAT", glslName(format)}, {"FILTERED_FORMAT", glslName(filtered)}, {"MEAN", mean}};
        defines["FILTERED_TYPE"] = oneChannel ? "vec2" : "vec4";
        if (oneChannel) defines.emplace("ONE_CHANNEL", "1");
        if (texels) defines.emplace("TEXELS", "1");
        return defines;
    }
    [[nodiscard]] Use reads(const std::string& records, bool previous = false) const {
        return {.port = records, .access = texels ? Access::Image : Access::Storage, .previous = previous};
    }
};

PassType SpatiotemporalFilter::type() {
    using F = SpatiotemporalFilter;
    return Describe<F>(
               "SpatiotemporalFilter",
               "Follows a noisy signal over frames and smooths it in space, guided by its variance (SVGF)")
        .input("signal", PortKind::Texture, "What is filtered: visibility, diffuse or specular light")
        .input("depth", PortKind::Texture, "Reversed depth of the surfaces")
        .carries(content::depth)
        .sameExtentAs("signal")
        .input("normal", PortKind::Texture, "Their normals, render space; 0 where nothing is")
        .carries(content::normal)
        .sameExtentAs("signal")
        .optionalInput(
            "motion", PortKind::Texture,
            "From each pixel to where its surface was in the last frame, in pixels; without it everything "
            "stays where it is")
        .carries(content::motion)
        .sameExtentAs("signal")
        .optionalInput("weight", PortKind::Texture,
                       "How much each pixel of this frame counts; without it all count alike")
        .carries({.channels = 1})
        .sameExtentAs("signal")
        .output("result", PortKind::Texture, "The filtered signal; as it was where nothing is")
        .output("history_length", PortKind::Texture, "Frames in each pixel's mean; 0 where nothing is")
        .carries({.channels = 1})
        .output("variance", PortKind::Texture,
                "Estimated variance that guides the smoothing in space: of the mean over frames; of one "
                "frame where the "
                "history is a filtered one")
        .carries({.channels = 1})
        .internal("integrated", PortKind::Texture, "Mean over frames, before it is smoothed in space")
        .internal("smoothed_once", PortKind::Texture,
                  "First iteration's result, where the history is a filtered one")
        .internal("moments", PortKind::Buffer, "Mean and variance of the brightness, frames, sum of weights")
        .internal("geometry", PortKind::Buffer, "Normal and distance along the view axis")
        .internal("change", PortKind::Texture,
                  "How much each tile has changed, and its usual square difference")
        .internal("filtered", PortKind::Buffer, "Signal and variance between iterations")
        .internal("filtered_again", PortKind::Buffer, "Signal and variance between iterations")
        .number("history", &F::history, 1, 1e4, "frames",
                "Longest history; from then on old frames fade exponentially. 1: this frame alone")
        .number("iterations", &F::iterations, 0, 5, "", "Of the spatial filter; each doubles its reach")
        .number("radius", &F::radius, 1, 2, "taps",
                "Taps of an iteration to each side: 3 x 3 or 5 x 5 in all")
        .number("sigma_depth", &F::sigmaDepth, 1e-6, 1e3, "half picture heights",
                "Distance from the surface's plane at which weights fall to 1/e, over half the picture's "
                "height there")
        .number("sigma_normal", &F::sigmaNormal, 0, 1e4, "", "Exponent of the cosine between normals")
        .number("sigma_luminance", &F::sigmaLuminance, 1e-3, 1e6, "deviations",
                "Difference of brightness at which weights fall to 1/e, in standard deviations of the mean")
        .number("depth_tolerance", &F::depthTolerance, 0, 1e3, "half picture heights",
                "How far off the surface's plane the last frame's surface may lie, over half the picture's "
                "height there")
        .number("normal_tolerance", &F::normalTolerance, 0, 180, "degrees",
                "How far the last frame's normal may be turned")
        .flag("gradient", &F::gradient,
              "Drops the history where the signal's mean over 8 x 8 pixels changes by more than its noise")
        .number("clamp", &F::clampDeviations, 0, 1e3, "deviations",
                "Clamps the history to the mean of the 5 x 5 pixels around and so many deviations; 0: not")
        .flag("filtered_history", &F::filteredHistory,
              "Goes on from the first iteration's result, as the paper does: less noise, more blur");
}

Declaration SpatiotemporalFilter::declare(const World& world, const Inputs& inputs,
                                          const Demand& demand) const {
    Declaration declaration;
    const Inputs::Input& signal = inputs["signal"];
    const FormatInfo& format = formatInfo(signal.desc.format);
    if (format.integer || format.depth || format.channels == 2)
        declaration.problems.push_back(
            {"signal", fmt::format("cannot be filtered: it is {}; one channel or colour is needed",
                                   describe(signal.desc))});

    Choices choices;
    choices.oneChannel = format.channels == 1;
    choices.format = choices.oneChannel ? Format::R32F : Format::RGBA32F;
    choices.filtered = choices.oneChannel ? Format::RG32F : Format::RGBA32F;
    const auto texture = [&](Format of) {
        return Desc::texture2D(of, signal.desc.extent, inputs["depth"].desc.view);
    };

    Output result{.port = "result", .desc = texture(choices.format)};
    Output length{.port = "history_length", .desc = texture(Format::R32F)};
    Output variance{.port = "variance", .desc = texture(Format::R32F)};
    const bool nothing =
        inputs["depth"].constant == glm::vec4(0) || inputs["normal"].constant == glm::vec4(0);
    if (signal.constant || nothing) { // a constant stays itself
        if (signal.constant)
            result.constant = signal.constant;
        else
            result = {.port = "result", .desc = signal.desc, .same = "signal"};
        length.constant = variance.constant = glm::vec4(0);
        declaration.outputs = {result, length, variance};
        declaration.leftOut.push_back({"filtering", nothing
                                                        ? "there is nothing in view"
                                                        : "the signal is the same everywhere and always"});
        return declaration;
    }

    choices.past = history > 1;
    choices.motion = choices.past && inputs.connected("motion") && inputs["motion"].constant != glm::vec4(0);
    choices.weighted = choices.past && inputs.connected("weight") && !inputs["weight"].constant;
    choices.gradient = choices.past && gradient;
    choices.historyLength = demand.reads("history_length");
    choices.variance = demand.reads("variance");
    choices.iterations = iterations;
    choices.filteredHistory = choices.past && filteredHistory && iterations > 0;
    choices.mean = iterations == 0 ? "result" : "integrated";
    choices.kept = choices.filteredHistory ? "smoothed_once" : choices.mean;

    const auto declareOutput = [&](const char* port, Format of, bool keeps = false) {
        declaration.outputs.push_back({.port = port, .desc = texture(of), .keeps = keeps && choices.past});
    };
    const std::uint64_t pixels = std::uint64_t{signal.desc.extent.width} * signal.desc.extent.height;
    choices.texels = pixels <= static_cast<std::uint64_t>(world.capabilities.maxTextureBufferTexels);
    const auto declareRecords = [&](const char* port, Format of, bool keeps = false) {
        declaration.outputs.push_back(
            {.port = port,
             .desc = Desc::buffer(pixels * static_cast<std::uint64_t>(formatInfo(of).bytes), of),
             .keeps = keeps && choices.past});
    };
    declareRecords("moments", Format::RGBA32F, true);
    declareRecords("geometry", Format::RGBA32F, true);
    result.keeps = choices.past && iterations == 0;
    declaration.outputs.push_back(result);
    if (iterations > 0) {
        declareOutput("integrated", choices.format, !choices.filteredHistory);
        declareRecords("filtered", choices.filtered);
        if (iterations > 1) declareRecords("filtered_again", choices.filtered);
    }
    if (choices.filteredHistory) declareOutput("smoothed_once", choices.format, true);
    if (choices.historyLength) declaration.outputs.push_back(length);
    if (choices.variance) declaration.outputs.push_back(variance);
    if (choices.gradient) {
        const Extent tiles{(signal.desc.extent.width + gradientTile - 1) / gradientTile,
                           (signal.desc.extent.height + gradientTile - 1) / gradientTile, 1};
        declaration.outputs.push_back(
            {.port = "change", .desc = Desc::texture2D(Format::RG32F, tiles), .keeps = true});
        declaration.steps.push_back(gradientStep(inputs, choices));
    }
    declaration.steps.push_back(temporalStep(inputs, choices));
    if (iterations > 0 || choices.variance) declaration.steps.push_back(varianceStep(choices));
    for (int i = 0; i < iterations; ++i) declaration.steps.push_back(iterationStep(i, choices));

    leaveOut(declaration, inputs, choices);
    declaration.depends = Causes::Properties | Causes::Cut | Causes::Size;
    declaration.always = choices.past;
    return declaration;
}

void SpatiotemporalFilter::leaveOut(Declaration& declaration, const Inputs& inputs, const Choices& choices) {
    if (!choices.past) declaration.leftOut.push_back({"history", "one frame is all of it"});
    if (choices.past && !choices.motion)
        declaration.leftOut.push_back({"reprojection", inputs.connected("motion")
                                                           ? "nothing in view moves"
                                                           : "no motion is connected"});
    if (choices.past && !choices.weighted && inputs.connected("weight"))
        declaration.leftOut.push_back({"weights", "they are the same everywhere"});
    if (choices.iterations == 0) declaration.leftOut.push_back({"spatial filtering", "it has no iterations"});
}

Step SpatiotemporalFilter::temporalStep(const Inputs& inputs, const Choices& choices) const {
    Step step{.name = "accumulate",
              .run = &SpatiotemporalFilter::accumulate,
              .shaders = {"filter/temporal.comp"},
              .defines = choices.defines(),
              .uses = {{.port = "signal", .access = Access::Image},
                       {.port = "depth", .access = Access::Fetch},
                       {.port = "normal", .access = Access::Fetch},
                       {.port = choices.mean, .access = Access::Image, .write = true},
                       {.port = "moments", .access = Access::Storage, .write = true},
                       {.port = "geometry", .access = Access::Storage, .write = true}},
              .group = "filter"};
    step.defines["SIGNAL_FORMAT"] = glslName(inputs["signal"].desc.format);
    if (choices.past) {
        step.defines.emplace("PAST", "1");
        step.defines["PREVIOUS_HISTORY"] = "previous_" + choices.kept;
        step.defines["PREVIOUS_VIEW"] = previousView(choices.kept);
        step.uses.push_back({.port = choices.kept, .access = Access::Image, .previous = true});
        step.uses.push_back(choices.reads("moments", true));
        step.uses.push_back(choices.reads("geometry", true));
    }
    if (choices.past && inputs["depth"].desc.view.jitter) step.defines.emplace("SEARCH", "1");
    if (choices.motion) {
        step.defines.emplace("MOTION", "1");
        step.uses.push_back({.port = "motion", .access = Access::Fetch});
    }
    if (choices.weighted) {
        step.defines.emplace("WEIGHTED", "1");
        step.uses.push_back({.port = "weight", .access = Access::Fetch});
    }
    if (choices.gradient) {
        step.defines.emplace("GRADIENT", "1");
        step.defines["TILE"] = std::to_string(gradientTile);
        step.uses.push_back({.port = "change", .access = Access::Fetch, .linear = true});
    }
    if (choices.past && clampDeviations > 0) step.defines.emplace("CLAMP", "1");
    if (choices.historyLength) {
        step.defines.emplace("HISTORY_LENGTH", "1");
        step.uses.push_back({.port = "history_length", .access = Access::Image, .write = true});
    }
    return step;
}

Step SpatiotemporalFilter::gradientStep(const Inputs& inputs, const Choices& choices) const {
    Step step{.name = "find_changes",
              .run = &SpatiotemporalFilter::findChanges,
              .shaders = {"filter/gradient.comp"},
              .defines = choices.defines(),
              .uses = {{.port = "signal", .access = Access::Image},
                       {.port = "depth", .access = Access::Fetch},
                       {.port = "normal", .access = Access::Fetch},
                       {.port = choices.kept, .access = Access::Image, .previous = true},
                       choices.reads("geometry", true),
                       {.port = "change", .access = Access::Image, .previous = true},
                       {.port = "change", .access = Access::Image, .write = true}},
              .group = "filter"};
    step.defines["SIGNAL_FORMAT"] = glslName(inputs["signal"].desc.format);
    step.defines["PREVIOUS_HISTORY"] = "previous_" + choices.kept;
    step.defines["PREVIOUS_VIEW"] = previousView(choices.kept);
    step.defines["TILE"] = std::to_string(gradientTile);
    step.defines.emplace("PAST", "1");
    if (choices.motion) {
        step.defines.emplace("MOTION", "1");
        step.uses.push_back({.port = "motion", .access = Access::Fetch});
    }
    return step;
}

Step SpatiotemporalFilter::varianceStep(const Choices& choices) const {
    Step step{.name = "estimate_variance",
              .run = &SpatiotemporalFilter::estimateVariance,
              .shaders = {"filter/variance.comp"},
              .defines = choices.defines(),
              .uses = {{.port = choices.mean, .access = Access::Image},
                       choices.reads("moments"),
                       choices.reads("geometry")},
              .group = "filter"};
    if (choices.iterations > 0) {
        step.defines["TARGET"] = filteredBlock(0);
        step.uses.push_back({.port = filteredPort(0), .access = Access::Storage, .write = true});
    }
    if (choices.filteredHistory) step.defines.emplace("OF_SAMPLES", "1");
    if (choices.variance) {
        step.defines.emplace("VARIANCE", "1");
        step.uses.push_back({.port = "variance", .access = Access::Image, .write = true});
    }
    return step;
}

Step SpatiotemporalFilter::iterationStep(int iteration, const Choices& choices) const {
    const bool isLast = iteration + 1 == choices.iterations;
    const bool isHistory = iteration == 0 && choices.filteredHistory;
    Step step{.name = fmt::format("smooth{}", iteration),
              .run = {&SpatiotemporalFilter::smooth, iteration},
              .shaders = {"filter/atrous.comp"},
              .defines = choices.defines(),
              .uses = {choices.reads(filteredPort(iteration)), choices.reads("geometry")},
              .group = "filter"};
    step.defines["SOURCE"] = filteredPort(iteration);
    step.defines["SOURCE_BLOCK"] = filteredBlock(iteration);
    step.defines["RADIUS"] = std::to_string(radius);
    step.defines["K1"] = radius == 1 ? "0.5" : "(2.0 / 3.0)"; // binomial weights over that of the centre
    step.defines["K2"] = "(1.0 / 6.0)";
    if (isLast) {
        step.defines.emplace("LAST", "1");
        step.uses.push_back({.port = "result", .access = Access::Image, .write = true});
    } else {
        step.defines["TARGET_BLOCK"] = filteredBlock(iteration + 1);
        step.uses.push_back({.port = filteredPort(iteration + 1), .access = Access::Storage, .write = true});
    }
    if (isHistory) {
        step.defines["HISTORY"] = choices.kept;
        step.uses.push_back({.port = choices.kept, .access = Access::Image, .write = true});
    }
    if (!choices.oneChannel && (isLast || isHistory)) {
        step.defines.emplace("ALPHA", "1");
        step.uses.push_back({.port = choices.mean, .access = Access::Image});
    }
    return step;
}

void SpatiotemporalFilter::setTolerances(Commands& commands) const {
    const bool restart = any(commands.causes() & (Causes::Cut | Causes::Size | Causes::Properties));
    commands.set("restart", restart ? 1 : 0);
    commands.set("depthTolerance", depthTolerance);
    commands.set("normalTolerance", std::cos(normalTolerance * std::numbers::pi_v<float> / 180.0f));
}

void SpatiotemporalFilter::findChanges(Commands& commands) const {
    setTolerances(commands);
    commands.dispatchOver(commands.desc("change").extent);
}

void SpatiotemporalFilter::accumulate(Commands& commands) const {
    setTolerances(commands);
    commands.set("frames", static_cast<float>(history));
    commands.set("clampDeviations", clampDeviations);
    commands.dispatchOver(commands.desc("result").extent);
}

void SpatiotemporalFilter::estimateVariance(Commands& commands) const {
    commands.set("sigmaDepth", sigmaDepth);
    commands.dispatchOver(commands.desc("result").extent);
}

void SpatiotemporalFilter::smooth(Commands& commands, int iteration) const {
    commands.set("sigmaDepth", sigmaDepth);
    commands.set("sigmaNormal", sigmaNormal);
    commands.set("sigmaLuminance", sigmaLuminance);
    commands.set("stride", 1 << iteration);
    commands.dispatchOver(commands.desc("result").extent);
}

} // namespace kestrel
