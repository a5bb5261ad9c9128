#include "reference_soft_shadow.h"
#include "draw/face_input.h"
#include "execute/commands.h"
#include "gather_pass.h"
#include <limits>

namespace kestrel {

PassType ReferenceSoftShadow::type() {
    Describe<ReferenceSoftShadow> table(
        "ReferenceSoftShadow",
        "Light straight from area lights and emissive meshes by Embree on the CPU: the truth");
    return addPlaces(table)
        .output("result", PortKind::Texture, "Irradiance over pi that arrives; 0 where nothing is")
        .carries(content::colour)
        .range(0, std::numeric_limits<double>::infinity())
        .output("visibility", PortKind::Texture,
                "How bright the result is over what it would be without shadows; 1 where no light reaches")
        .range(0, 1)
        .number("samples", &ReferenceSoftShadow::samples, 2, 65536, "rays",
                "Rays a pixel for all emitters together, rounded up to an even number")
        .flag("emission", &ReferenceSoftShadow::emission,
              "Emissive meshes shine too, but for those that only show where an area light is");
}

Declaration ReferenceSoftShadow::declare(const World& world, const Inputs& inputs, const Demand&) const {
    const SceneFacts& facts = world.facts;
    const bool dark = facts.rectangleLights + facts.sphereLights == 0 && !(emission && facts.hasEmission);
    Declaration declaration =
        declareGather(inputs, {"position", "normal"}, {"result", "visibility"},
                      dark ? "the scene has no area light and no material that counts emits light" : "");
    for (Output& output : declaration.outputs)
        if (output.port == "visibility" && output.constant) output.constant = glm::vec4(1);
    return declaration;
}

void ReferenceSoftShadow::execute(const Step& step, Commands& commands) {
    GatherSettings settings = gatherSettings(commands, samples, 0);
    settings.emission = emission;
    const ReferenceTracer tracer(commands.geometry(), commands.scene());
    const GatherScene scene{tracer, commands.geometry(), commands.scene(), commands.lights()};
    const GatherResult result = gatherSoftShadow(scene, gatherInputs(step, commands), settings);
    finishGather(commands, result);
    commands.uploadImage("visibility", result.visibility);
}

} // namespace kestrel
