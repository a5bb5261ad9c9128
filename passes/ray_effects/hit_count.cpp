#include "hit_count.h"
#include "draw/material_defines.h"
#include "execute/commands.h"

namespace kestrel {

PassType HitCount::type() {
    return Describe<HitCount>("HitCount",
                              "Counts every surface along each pixel's ray, front and back sides alike")
        .input("hits", PortKind::Hits, "Who enumerates the hits")
        .output("count", PortKind::Texture, "Hits between the near and the far plane")
        .number("divisor", &HitCount::divisor, 1, 16, "",
                "Resolution per axis is that of the frame divided by this");
}

Declaration HitCount::declare(const World& world, const Inputs&, const Demand&) const {
    Declaration declaration;
    const View view{.source = {}, .divisor = divisor, .guard = 0, .jitter = false};
    declaration.outputs.push_back(
        {.port = "count", .desc = Desc::texture2D(Format::R32F, world.extentOf(view), view)});
    if (world.facts.triangles == 0) {
        declaration.outputs.back().constant = glm::vec4(0);
        declaration.leftOut.push_back({"counting", "the scene has no triangle"});
        return declaration;
    }
    declaration.steps.push_back({.name = "count",
                                 .shaders = {"ray_effects/hit_count.comp"},
                                 .defines = materialDefines(world.facts),
                                 .uses = {{.port = "count", .access = Access::Image, .write = true}},
                                 .modules = {{"hits", requests::AllHits}},
                                 .group = "tracing"});
    declaration.depends = Causes::Camera | Causes::Cut | Causes::Size | Causes::Properties;
    return declaration;
}

void HitCount::execute(const Step&, Commands& commands) {
    commands.dispatchOver(commands.desc("count").extent);
}

} // namespace kestrel
