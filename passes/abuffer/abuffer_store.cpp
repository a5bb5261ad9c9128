#include "abuffer_store.h"
#include "draw/material_defines.h"
#include "views.h"
#include <algorithm>
#include <fmt/format.h>
#include <string_view>

namespace kestrel {

namespace {

using Structure = FragmentLists::Structure;

// Pixels whose fragments one invocation adds up: few enough for one invocation to add up the runs.
constexpr std::uint64_t pixelsPerRun = 256;
constexpr std::uint64_t maxRuns = 60'000;
// Nodes that there is room for at first, for each pixel; what is really wanted is told by the counter.
constexpr std::uint64_t nodesPerPixel = 2;

} // namespace

PassType ABufferStore::type() {
    return Describe<ABufferStore>("ABufferStore",
                                  "Stores every fragment of every view in a list of its pixel")
        .input("bounds", PortKind::Texture, "Depth bounds and number of fragments in the frame's view")
        .carries({.channels = 4, .space = Space::View})
        .input("cube_bounds", PortKind::Texture, "The same of the cube's faces")
        .carries({.channels = 4, .space = Space::View})
        .output("pixels", PortKind::Buffer, "What each pixel of each view knows of its list, unsorted")
        .output("nodes", PortKind::Buffer, "The nodes: depth and links")
        .output("data", PortKind::Buffer, "The triangle of each node, where data is decoupled")
        .output("segments", PortKind::Buffer,
                "With `counted`: the pixel's first node, and the one after its last")
        .internal("counter", PortKind::Buffer, "Nodes in all")
        .internal("runs", PortKind::Buffer, "Fragments before each run of pixels")
        .choice("structure", &ABufferStore::structure, {"sb", "ll", "dll", "llb", "dllb"},
                "Side by side; linked one way or both ways; the same by buckets")
        .number("buckets", &ABufferStore::buckets, 1, 16, "buckets",
                "Equal parts of a pixel's depth range, with llb and dllb")
        .flag("decoupled", &ABufferStore::decoupled,
              "Keeps what shading needs apart from what traversal needs")
        .choice("allocation", &ABufferStore::allocation, {"counter", "counted"},
                "Addresses from one counter, as in the paper (not with sb), or from how many fragments each "
                "pixel has");
}

Declaration ABufferStore::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    FragmentLists lists = inputs["bounds"].desc.lists;
    const bool bucketed = structure == Structure::LLB || structure == Structure::DLLB;
    lists.structure = structure;
    lists.buckets = bucketed ? buckets : 1;
    lists.decoupled = decoupled;
    if (inputs["bounds"].desc.lists != inputs["cube_bounds"].desc.lists)
        declaration.problems.push_back({"cube_bounds", "is of another pass than `bounds`"});
    if (structure == Structure::SB && allocation == ABufferAllocation::Counter)
        declaration.leftOut.push_back({"the one counter", "the nodes of sb lie side by side"});

    const std::uint64_t pixels = abufferPixels(lists, world.size);
    const std::uint64_t capacity = std::max(demand.grown("nodes"), nodesPerPixel * pixels);
    const bool nothing = !abufferHasFragments(lists, world.facts) || pixels == 0;
    const auto buffer = [&](const char* port, std::uint64_t words) -> Output& {
        const std::uint64_t bytes = std::max<std::uint64_t>(words, 1) * 4;
        if (static_cast<std::int64_t>(words) > world.capabilities.maxTextureBufferTexels)
            declaration.problems.push_back(
                {port,
                 fmt::format("needs {} texels in a buffer texture; the limit is {}", words,
                             world.capabilities.maxTextureBufferTexels),
                 true});
        Desc desc = Desc::buffer(bytes, Format::R32UI);
        desc.lists = lists;
        desc.extent = world.size; // the frame's view is told with every buffer
        declaration.outputs.push_back({.port = port, .desc = desc});
        return declaration.outputs.back();
    };
    const bool counted = isCounted();
    const glm::vec4 none(0);
    Output& words = buffer("pixels", pixels * static_cast<std::uint64_t>(abufferPixelWords(lists)));
    if (nothing) words.constant = none;
    if (!nothing && !counted && !bucketed) words.clear = none;
    Output& nodes = buffer("nodes", capacity * static_cast<std::uint64_t>(abufferNodeWords(lists)));
    if (nothing) nodes.constant = none;
    if (!nothing) {
        nodes.counter = "counter";
        nodes.capacity = capacity;
    }
    Output& data = buffer("data", decoupled ? capacity : 0);
    if (nothing || !decoupled) data.constant = none;
    Output& segments = buffer("segments", counted ? 2 * pixels : 0);
    if (nothing || !counted) segments.constant = none;

    declaration.depends = Causes::Camera | Causes::Cut | Causes::Geometry | Causes::Transforms |
                          Causes::Materials | Causes::Properties | Causes::Size;
    if (nothing) {
        declaration.leftOut.push_back({"drawing", pixels == 0 ? "no view is asked for"
                                                  : world.facts.triangles == 0
                                                      ? "the scene has no triangles"
                                                      : "no material is blended, and others are not stored"});
        return declaration;
    }
    declaration.outputs.push_back({.port = "counter", .desc = Desc::buffer(4), .clear = none});
    if (!world.facts.hasMasked)
        declaration.leftOut.push_back({"alpha test", "no material is masked or blended"});
    if (counted || bucketed) {
        const std::uint64_t runs = (pixels + pixelsPerRun - 1) / pixelsPerRun;
        if (runs > maxRuns)
            declaration.problems.push_back(
                {"", fmt::format("{} pixels in all views; the limit is {}", pixels, maxRuns * pixelsPerRun),
                 true});
        if (counted) buffer("runs", runs);
        for (Step& step : beginSteps(abufferDefines(lists, world.size), lists, pixels))
            declaration.steps.push_back(std::move(step));
    }
    if (lists.mainView) declaration.steps.push_back(drawStep(world, lists, false));
    if (lists.side > 0) declaration.steps.push_back(drawStep(world, lists, true));
    return declaration;
}

std::vector<Step> ABufferStore::beginSteps(const Defines& given, const FragmentLists& lists,
                                           std::uint64_t pixels) const {
    const auto runs = static_cast<std::uint32_t>((pixels + pixelsPerRun - 1) / pixelsPerRun);
    const auto stepOf = [&](const char* name, const char* what, bool reads, std::vector<Use> uses) {
        Step step{.name = name,
                  .shaders = {"abuffer/segments.comp"},
                  .defines = given,
                  .uses = std::move(uses),
                  .group = "store"};
        const bool scan = std::string_view(what) == "SCAN";
        step.defines.emplace(what, "1");
        step.defines.emplace("RUN", std::to_string(pixelsPerRun));
        step.defines.emplace("RUNS", std::to_string(runs));
        step.defines.emplace("PIXELS_IN_ALL", std::to_string(pixels));
        step.defines.emplace("LOCAL_SIZE", scan ? "1" : "8");
        step.run = [runs, scan](Commands& commands) { commands.dispatchOver(scan ? 1 : runs); };
        if (reads && lists.mainView) step.uses.push_back({.port = "bounds", .access = Access::Image});
        if (reads && lists.side > 0) step.uses.push_back({.port = "cube_bounds", .access = Access::Image});
        return step;
    };
    const Use words{.port = "pixels", .access = Access::Image, .write = true};
    const Use runsWritten{.port = "runs", .access = Access::Image, .write = true};
    if (!isCounted()) return {stepOf("ranges", "RANGES", true, {words})};
    return {stepOf("sum", "SUM", true, {runsWritten}),
            stepOf("scan", "SCAN", false,
                   {runsWritten, {.port = "counter", .access = Access::Storage, .write = true}}),
            stepOf("place", "PLACE", true,
                   {{.port = "runs", .access = Access::Image},
                    {.port = "segments", .access = Access::Image, .write = true},
                    words})};
}

Step ABufferStore::drawStep(const World& world, const FragmentLists& lists, bool ofCube) const {
    Step step{.name = ofCube ? "faces" : "frame",
              .shaders = abufferShaders(lists, ofCube, "abuffer/store.frag"),
              .defines = materialDefines(world.facts, lists.blended),
              .uses = {{.port = "nodes", .access = Access::Image, .write = true}},
              .group = "store"};
    step.defines.merge(abufferDefines(lists, world.size));
    if (ofCube) step.defines.emplace("CUBE", "1");
    if (lists.decoupled) step.uses.push_back({.port = "data", .access = Access::Image, .write = true});
    if (!isCounted()) {
        step.defines.emplace("COUNTER", "1");
        step.defines.emplace("VIEW_BLOCK", "PixelsView");
        step.uses.push_back({.port = "pixels", .access = Access::Image, .write = true});
        step.uses.push_back({.port = "counter", .access = Access::Storage, .write = true});
    } else {
        step.defines.emplace("VIEW_BLOCK", "SegmentsView");
        step.uses.push_back({.port = "segments", .access = Access::Image, .write = true});
    }
    const Extent& frame = world.size;
    const auto side = static_cast<std::uint32_t>(lists.side);
    const auto viewport = ofCube ? glm::uvec2(side) : glm::uvec2(frame.width, frame.height);
    step.run = [viewport, ofCube, classes = abufferClasses(lists.blended)](Commands& commands) {
        DrawState state = DrawState::overwrite();
        state.viewport = viewport;
        commands.set("capacity",
                     static_cast<std::uint32_t>(commands.desc("nodes").bytes / 4) /
                         static_cast<std::uint32_t>(abufferNodeWords(commands.desc("nodes").lists)));
        for (std::uint32_t face = 0; face < (ofCube ? shared::abufferFaces : 1); ++face) {
            if (ofCube) commands.set("face", face);
            commands.drawScene(state, classes);
        }
    };
    return step;
}

} // namespace kestrel
