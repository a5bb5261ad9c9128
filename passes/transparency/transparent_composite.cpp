#include "transparent_composite.h"
#include "blended_light.h"
#include "execute/commands.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel {

namespace {

// Surfaces of a pixel that one step shades. An invocation may walk through 16,000 more, which is the longest
// list there is, and stays below the iterations that every driver runs (shader/iterations.h): a light takes
// up to 24 for each surface with its largest filter, where it is one of several kinds and maps.
int surfacesAStep(const SceneFacts& facts) {
    return 40'000 / (8 + 24 * static_cast<int>(std::min(facts.lights(), 64u)));
}

} // namespace

PassType TransparentComposite::type() {
    Describe<TransparentComposite> table("TransparentComposite",
                                         "Blended materials in the order of their depths over an opaque "
                                         "picture");
    return addBlended(table)
        .input("layers", PortKind::Layers,
               "The blended surfaces at each pixel, with their triangles: all of ABuffer (its ABufferBounds "
               "with `blended` kept or alone), the nearest of DepthPeeling or KBuffer")
        .output("result", PortKind::Texture, "Radiance with the blended surfaces; a: how much is covered")
        .carries({.channels = 4})
        .internal("longest", PortKind::Buffer, "Surfaces at a pixel, where more than there are steps for")
        .vector("ambient", &TransparentComposite::ambient, 0, 1e9, "radiance",
                "Light from all sides besides the radiance: base colour times this, but of metals")
        .number(
            "cutoff", &TransparentComposite::cutoff, 0, 1, "",
            "What lies behind surfaces that let through no more than this share is not looked for; 0: all "
            "is");
}

Declaration TransparentComposite::declare(const World& world, const Inputs& inputs,
                                          const Demand& demand) const {
    Declaration declaration;
    const Desc& picture = inputs["picture"].desc;
    declaration.outputs = {
        {.port = "result", .desc = Desc::texture2D(Format::RGBA32F, picture.extent, picture.view)}};
    if (leavesOutBlended(world, declaration)) return declaration;

    const Desc& layers = inputs["layers"].desc;
    const Desc& depth = inputs["depth"].desc;
    checkBlendedView(depth, declaration);
    View unmoved = depth.view;
    unmoved.jitter = layers.view.jitter;
    if (layers.view != unmoved)
        declaration.problems.push_back({"layers", "is not seen as `depth` is: divisor, guard band"});
    else if (layers.view != depth.view)
        declaration.leftOut.push_back(
            {"jitter of blended surfaces", "the layers are taken in the middles of pixels"});
    if (layers.depthLayers.blended != Blended::Kept && layers.depthLayers.blended != Blended::Alone)
        declaration.leftOut.push_back(
            {"blended surfaces below their cutoff",
             "the layers do not hold them (`blended` of ABufferBounds is neither kept nor alone)"});

    const int each = surfacesAStep(world.facts);
    const auto wanted = static_cast<int>(std::min<std::uint64_t>(demand.grown("result"), 1 << 20));
    const int steps = std::max((wanted + each - 1) / each, 1);
    declaration.outputs.front().counter = "longest";
    declaration.outputs.front().capacity =
        static_cast<std::uint64_t>(each) * static_cast<std::uint64_t>(steps);
    declaration.outputs.push_back({.port = "longest", .desc = Desc::buffer(4), .clear = glm::vec4(0)});
    for (int i = 0; i < steps; ++i) {
        Step step{.name = fmt::format("composite{}", i),
                  .run = &TransparentComposite::composite,
                  .shaders = {"transparency/composite.comp"},
                  .uses = {{.port = "picture", .access = Access::Fetch},
                           {.port = "depth", .access = Access::Fetch},
                           {.port = "result", .access = Access::Image, .write = true}},
                  .modules = {{"layers", requests::Surface}},
                  .group = "composite"};
        lightBlended(world, inputs, ambient, step);
        step.defines.insert({{"STEP", std::to_string(each)}, {"SKIPPED", std::to_string(i * each)}});
        if (i > 0) step.defines.emplace("CONTINUES", "1");
        if (i + 1 == steps) {
            step.defines.emplace("ENDS", "1");
            step.uses.push_back({.port = "longest", .access = Access::Storage, .write = true});
        }
        declaration.steps.push_back(std::move(step));
    }
    declaration.depends = Causes::Camera | Causes::Cut | Causes::Geometry | Causes::Transforms |
                          Causes::Materials | Causes::Properties;
    return declaration;
}

void TransparentComposite::composite(Commands& commands) const {
    if (ambient != glm::vec3(0)) commands.set("ambient", ambient);
    commands.set("cutoff", cutoff);
    commands.dispatchOver(commands.desc("result").extent);
}

} // namespace kestrel
