#include "hemisphere_rays.h"
#include "draw/face_input.h"
#include "execute/commands.h"
#include "shared/ray.h"

namespace kestrel {

PassType HemisphereRays::type() {
    Describe<HemisphereRays> table("HemisphereRays",
                                   "One ray a pixel over the cosine-weighted hemisphere, as a buffer");
    return addSurface(table)
        .output("rays", PortKind::Buffer, "One record a pixel in rows from the bottom (shared/ray.h)")
        .carries(content::elements("RayRecord"))
        .number("distance", &HemisphereRays::distance, 0, 1e9, "scene units",
                "Length of the rays; 0: unbounded");
}

Declaration HemisphereRays::declare(const World&, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Extent extent = inputs["depth"].desc.extent;
    const std::uint64_t pixels = std::uint64_t{extent.width} * extent.height;
    declaration.outputs.push_back(
        {.port = "rays", .desc = Desc::buffer(pixels * sizeof(shared::RayRecord), Format::RGBA32UI)});
    Step step{.name = "generate",
              .shaders = {"ray_effects/hemisphere_rays.comp"},
              .uses = {{.port = "depth", .access = Access::Fetch},
                       {.port = "normal", .access = Access::Image},
                       {.port = "rays", .access = Access::Storage, .write = true}},
              .group = "rays"};
    useFaceNormal(declaration, step, inputs);
    declaration.steps.push_back(std::move(step));
    declaration.depends = Causes::Frame | Causes::Properties;
    return declaration;
}

void HemisphereRays::execute(const Step&, Commands& commands) {
    commands.set("maximumDistance", distance);
    commands.dispatchOver(commands.desc("depth").extent);
}

} // namespace kestrel
