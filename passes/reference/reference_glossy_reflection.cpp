#include "reference_glossy_reflection.h"
#include "draw/face_input.h"
#include "execute/commands.h"
#include "gather_pass.h"
#include <limits>

namespace kestrel {

PassType ReferenceGlossyReflection::type() {
    Describe<ReferenceGlossyReflection> table(
        "ReferenceGlossyReflection", "Light reflected by rough surfaces by Embree on the CPU: the truth");
    return addPlaces(table)
        .input("albedo", PortKind::Texture, "Their linear base colour")
        .carries(content::colour)
        .sameExtentAs("position")
        .input("material", PortKind::Texture, "Their roughness, metallic, and in z whether they are unlit")
        .carries(content::material)
        .sameExtentAs("position")
        .output("result", PortKind::Texture,
                "Radiance that leaves towards the eye by the specular lobe; 0 where nothing is")
        .carries(content::colour)
        .range(0, std::numeric_limits<double>::infinity())
        .number("samples", &ReferenceGlossyReflection::samples, 2, 65536, "rays",
                "Rays a pixel, rounded up to an even number")
        .number("distance", &ReferenceGlossyReflection::distance, 0, 1e9, "scene units",
                "How far surfaces count, beyond it a ray meets nothing; 0: any distance")
        .flag("emission", &ReferenceGlossyReflection::emission,
              "Surfaces send out their emission too; off where area lights stand for the meshes that glow")
        .vector("environment", &ReferenceGlossyReflection::environment, 0, 1e9, "radiance",
                "What arrives where a ray meets nothing");
}

Declaration ReferenceGlossyReflection::declare(const World&, const Inputs& inputs, const Demand&) const {
    Declaration declaration = declareGather(inputs, {"position", "normal", "albedo", "material"}, {"result"});
    declaration.depends |= Causes::Camera | Causes::Cut;
    return declaration;
}

void ReferenceGlossyReflection::execute(const Step& step, Commands& commands) {
    GatherSettings settings = gatherSettings(commands, samples, distance);
    settings.emission = emission;
    settings.environment = environment;
    GatherInputs inputs = gatherInputs(step, commands);
    inputs.albedo = commands.downloadImage("albedo");
    inputs.material = commands.downloadImage("material");
    const ReferenceTracer tracer(commands.geometry(), commands.scene());
    const GatherScene scene{tracer, commands.geometry(), commands.scene(), commands.lights()};
    finishGather(commands, gatherGlossyReflection(scene, inputs, commands.frame().cameraState, settings));
}

} // namespace kestrel
