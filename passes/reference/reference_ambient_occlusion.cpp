#include "reference_ambient_occlusion.h"
#include "draw/face_input.h"
#include "execute/commands.h"
#include "gather_pass.h"
#include "reference/ambient_occlusion.h"

namespace kestrel {

PassType ReferenceAmbientOcclusion::type() {
    Describe<ReferenceAmbientOcclusion> table("ReferenceAmbientOcclusion",
                                              "Ambient occlusion by Embree on the CPU: the truth");
    return addPlaces(table)
        .output("visibility", PortKind::Texture,
                "Share of the cosine-weighted hemisphere that is open; 1 where nothing is")
        .carries({.channels = 1})
        .range(0, 1)
        .number("samples", &ReferenceAmbientOcclusion::samples, 2, 65536, "rays",
                "Rays a pixel, rounded up to an even number")
        .number("distance", &ReferenceAmbientOcclusion::distance, 0, 1e9, "scene units",
                "How far occluders count; 0: any distance");
}

Declaration ReferenceAmbientOcclusion::declare(const World&, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Desc& position = inputs["position"].desc;
    Output visibility{.port = "visibility",
                      .desc = Desc::texture2D(Format::R32F, position.extent, position.view)};
    if (inputs["position"].constant) { // nothing in view
        visibility.constant = glm::vec4(1);
        declaration.outputs.push_back(std::move(visibility));
        declaration.leftOut.push_back({"tracing", "there is nothing in view"});
        return declaration;
    }
    declaration.outputs.push_back(std::move(visibility));
    Step step{.name = "trace",
              .uses = {{.port = "position", .access = Access::Host},
                       {.port = "normal", .access = Access::Host},
                       {.port = "visibility", .access = Access::Copy, .write = true}},
              .group = "reference"};
    useFaceNormal(declaration, step, inputs, Access::Host);
    declaration.steps.push_back(std::move(step));
    declaration.depends = Causes::Geometry | Causes::Transforms | Causes::Materials | Causes::Properties;
    return declaration;
}

void ReferenceAmbientOcclusion::execute(const Step& step, Commands& commands) {
    const ReferenceTracer tracer(commands.geometry(), commands.scene());
    OcclusionSettings settings;
    settings.samples = samples;
    if (distance > 0) settings.maximumDistance = distance;
    settings.seed = commands.frame().seed;
    settings.progress = [&](double fraction) { commands.progress(fraction); };
    OcclusionInputs inputs{.position = commands.downloadImage("position"),
                           .normal = commands.downloadImage("normal"),
                           .faceNormal = {}};
    inputs.faceNormal = facesOf(step, commands, inputs.position, inputs.normal);
    const OcclusionResult result = ambientOcclusion(tracer, inputs, settings);
    commands.uploadImage("visibility", result.visibility);
    commands.report("noise", result.noise);
    commands.report("rays", static_cast<double>(result.rays));
}

} // namespace kestrel
