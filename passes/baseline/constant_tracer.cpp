#include "constant_tracer.h"
#include <fmt/format.h>

namespace kestrel {

PassType ConstantTracer::type() {
    return Describe<ConstantTracer>("ConstantTracer",
                                    "Answers every ray alike: what an effect costs besides tracing")
        .output("tracer", PortKind::Tracer, "Meets something at one distance along each ray, or nothing")
        .number("distance", &ConstantTracer::distance, 0, 1e6, "radii of the scene's sphere",
                "After which every ray meets something; 0: none does");
}

Declaration ConstantTracer::declare(const World& world, const Inputs&, const Demand& demand) const {
    Declaration declaration;
    declaration.outputs = {{.port = "tracer", .desc = Desc::module(provides::Approximate)}};
    if (!demand.reads("tracer")) return declaration;
    Module tracer{.port = "tracer", .shader = "baseline/constant_tracer.glsl"};
    const float length = distance * world.facts.sphere.radius;
    // A literal: nothing is read, and the compiler drops what a ray without a hit does not need.
    if (length > 0) tracer.defines.emplace("DISTANCE", fmt::format("{:#.9g}", length));
    declaration.modules.push_back(std::move(tracer));
    return declaration;
}

} // namespace kestrel
