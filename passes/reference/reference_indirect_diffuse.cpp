#include "reference_indirect_diffuse.h"
#include "draw/face_input.h"
#include "execute/commands.h"
#include "gather_pass.h"
#include <limits>

namespace kestrel {

PassType ReferenceIndirectDiffuse::type() {
    Describe<ReferenceIndirectDiffuse> table("ReferenceIndirectDiffuse",
                                             "One bounce of diffuse light by Embree on the CPU: the truth");
    return addPlaces(table)
        .output("result", PortKind::Texture,
                "Cosine-weighted mean of the radiance that arrives (irradiance over pi); 0 where nothing is")
        .carries(content::colour)
        .range(0, std::numeric_limits<double>::infinity())
        .output("weight", PortKind::Texture, "1: all frames count alike")
        .number("samples", &ReferenceIndirectDiffuse::samples, 2, 65536, "rays",
                "Rays a pixel, rounded up to an even number")
        .number("distance", &ReferenceIndirectDiffuse::distance, 0, 1e9, "scene units",
                "How far surfaces count, beyond it a ray meets nothing; 0: any distance")
        .flag("emission", &ReferenceIndirectDiffuse::emission,
              "Surfaces send out their emission too; off where area lights stand for the meshes that glow")
        .vector("environment", &ReferenceIndirectDiffuse::environment, 0, 1e9, "radiance",
                "What arrives where a ray meets nothing");
}

Declaration ReferenceIndirectDiffuse::declare(const World&, const Inputs& inputs, const Demand&) const {
    Declaration declaration = declareGather(inputs, {"position", "normal"}, {"result"});
    declaration.outputs.push_back(
        {.port = "weight",
         .desc = Desc::texture2D(Format::R32F, inputs["position"].desc.extent, inputs["position"].desc.view),
         .constant = glm::vec4(1)});
    return declaration;
}

void ReferenceIndirectDiffuse::execute(const Step& step, Commands& commands) {
    GatherSettings settings = gatherSettings(commands, samples, distance);
    settings.emission = emission;
    settings.environment = environment;
    const ReferenceTracer tracer(commands.geometry(), commands.scene());
    const GatherScene scene{tracer, commands.geometry(), commands.scene(), commands.lights()};
    finishGather(commands, gatherIndirectDiffuse(scene, gatherInputs(step, commands), settings));
}

} // namespace kestrel
