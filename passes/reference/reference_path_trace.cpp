#include "reference_path_trace.h"
#include "draw/no_light.h"
#include "execute/commands.h"
#include "gather_pass.h"
#include "reference/path_trace.h"

namespace kestrel {

PassType ReferencePathTrace::type() {
    Describe<ReferencePathTrace> table(
        "ReferencePathTrace", "Path tracing by Embree on the CPU from the surfaces of a G-buffer: the "
                              "truth");
    return addPlaces(table)
        .input("albedo", PortKind::Texture, "Their linear base colour")
        .carries(content::colour)
        .sameExtentAs("position")
        .input("material", PortKind::Texture, "Their roughness, metallic, and in z whether they are unlit")
        .carries(content::material)
        .sameExtentAs("position")
        .optionalInput("emission", PortKind::Texture, "The radiance that they send out of themselves")
        .carries(content::colour)
        .sameExtentAs("position")
        .optionalInput("refraction", PortKind::Texture,
                       "Their transmission and relative index of refraction; without it they are opaque")
        .carries({.channels = 2})
        .sameExtentAs("position")
        .output("result", PortKind::Texture, "What reaches the camera; the environment where nothing is")
        .carries(content::colour)
        .range(0, std::numeric_limits<double>::infinity())
        .output("indirect", PortKind::Texture, "The part of it that came along at least one ray of a path")
        .carries(content::colour)
        .range(0, std::numeric_limits<double>::infinity())
        .number("samples", &ReferencePathTrace::samples, 2, 65536, "paths",
                "Paths a pixel, rounded up to an even number")
        .number("bounces", &ReferencePathTrace::bounces, 1, 8, "rays",
                "Rays of a path after the one that the G-buffer stands for")
        .flag("area_lights", &ReferencePathTrace::areaLights,
              "Rectangle and sphere lights are sampled; off: the meshes that show them light along every ray")
        .vector("environment", &ReferencePathTrace::environment, 0, 1e9, "radiance",
                "What arrives where a ray meets nothing");
}

Declaration ReferencePathTrace::declare(const World&, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Desc& position = inputs["position"].desc;
    const bool empty = inputs["position"].constant.has_value();
    Step step{.name = "trace", .group = "reference"};
    for (const char* port : {"position", "normal", "albedo", "material", "emission", "refraction"})
        if (inputs.connected(port)) step.uses.push_back({.port = port, .access = Access::Host});
    for (const char* port : {"result", "indirect"}) {
        Output output{.port = port, .desc = Desc::texture2D(Format::RGBA32F, position.extent, position.view)};
        if (empty) output.constant = std::string_view(port) == "result" ? glm::vec4(environment, 1) : noLight;
        declaration.outputs.push_back(std::move(output));
        step.uses.push_back({.port = port, .access = Access::Copy, .write = true});
    }
    declaration.depends = Causes::Properties;
    if (empty) {
        declaration.leftOut.push_back({"tracing", "there is nothing in view"});
        return declaration;
    }
    useFaceNormal(declaration, step, inputs, Access::Host);
    declaration.steps.push_back(std::move(step));
    declaration.depends |= Causes::Geometry | Causes::Transforms | Causes::Materials | Causes::Lights |
                           Causes::Camera | Causes::Cut;
    return declaration;
}

void ReferencePathTrace::execute(const Step& step, Commands& commands) {
    PathInputs inputs;
    static_cast<GatherInputs&>(inputs) = gatherInputs(step, commands);
    inputs.albedo = commands.downloadImage("albedo");
    inputs.material = commands.downloadImage("material");
    if (commands.uses("emission")) inputs.emission = commands.downloadImage("emission");
    if (commands.uses("refraction")) inputs.refraction = commands.downloadImage("refraction");
    PathSettings settings;
    settings.samples = samples;
    settings.bounces = bounces;
    settings.areaLights = areaLights;
    settings.environment = environment;
    settings.seed = commands.frame().seed;
    settings.progress = [&commands](double fraction) { commands.progress(fraction); };
    const ReferenceTracer tracer(commands.geometry(), commands.scene());
    const GatherScene scene{tracer, commands.geometry(), commands.scene(), commands.lights()};
    const PathResult result = tracePaths(scene, inputs, commands.frame().cameraState, settings);
    commands.uploadImage("result", withOpaqueAlpha(result.radiance));
    commands.uploadImage("indirect", withOpaqueAlpha(result.indirect));
    commands.report("noise", result.noise);
    commands.report("samples", static_cast<double>(result.samples));
}

} // namespace kestrel
