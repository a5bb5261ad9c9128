#include "reference_transparency.h"
#include "execute/commands.h"
#include "reference/transparency.h"
#include <algorithm>
#include <numeric>

namespace kestrel {

PassType ReferenceTransparency::type() {
    return Describe<ReferenceTransparency>(
               "ReferenceTransparency",
               "Blended materials over an opaque picture, in order, by Embree on the CPU: the truth")
        .input("picture", PortKind::Texture,
               "Radiance of what is opaque; a is 1 where something is (GBuffer with `blended` left_out)")
        .carries({.channels = 4})
        .output("result", PortKind::Texture, "Radiance with the blended surfaces; a: how much is covered")
        .carries({.channels = 4})
        .output("surfaces", PortKind::Texture, "How many of them each pixel shows")
        .carries({.channels = 1})
        .number("samples", &ReferenceTransparency::samples, 1, 65536, "rays",
                "Points on area lights for each surface")
        .flag("shadows", &ReferenceTransparency::shadows, "Without them light passes through everything")
        .flag("emission", &ReferenceTransparency::emission, "Surfaces send out their emission too")
        .flag("highlights", &ReferenceTransparency::highlights,
              "And what point, spot and directional lights reflect specularly")
        .vector("ambient", &ReferenceTransparency::ambient, 0, 1e9, "radiance",
                "Light from all sides besides");
}

Declaration ReferenceTransparency::declare(const World& world, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Desc& picture = inputs["picture"].desc;
    View view = picture.view;
    view.jitter = false;
    if (view != View{})
        declaration.problems.push_back(
            {"picture", "is not what the frame's camera sees, pixel by pixel and without guard band"});
    else if (picture.view.jitter)
        declaration.leftOut.push_back({"jitter", "rays go through the middles of pixels"});
    declaration.outputs = {
        {.port = "result", .desc = Desc::texture2D(Format::RGBA32F, picture.extent, picture.view)},
        {.port = "surfaces", .desc = Desc::texture2D(Format::R32F, picture.extent, picture.view)}};
    if (!world.facts.hasBlend) {
        declaration.outputs[0].same = "picture";
        declaration.outputs[1].constant = glm::vec4(0);
        declaration.leftOut.push_back({"tracing", "no material is blended: the picture stays as it is"});
        return declaration;
    }
    declaration.steps = {{.name = "composite",
                          .uses = {{.port = "picture", .access = Access::Host},
                                   {.port = "result", .access = Access::Copy, .write = true},
                                   {.port = "surfaces", .access = Access::Copy, .write = true}},
                          .group = "reference"}};
    declaration.depends = Causes::Camera | Causes::Cut | Causes::Geometry | Causes::Transforms |
                          Causes::Materials | Causes::Lights | Causes::Properties;
    return declaration;
}

void ReferenceTransparency::execute(const Step&, Commands& commands) {
    TransparencySettings settings;
    settings.samples = samples;
    settings.shadows = shadows;
    settings.emission = emission;
    settings.highlights = highlights;
    settings.ambient = ambient;
    settings.seed = commands.frame().seed;
    settings.progress = [&commands](double fraction) { commands.progress(fraction); };
    const ReferenceTracer seen(commands.geometry(), commands.scene(), false);
    const ReferenceTracer tracer(commands.geometry(), commands.scene());
    const GatherScene scene{tracer, commands.geometry(), commands.scene(), commands.lights()};
    const TransparencyResult result = compositeBlended(scene, seen, commands.frame().cameraState,
                                                       commands.downloadImage("picture"), settings);
    commands.uploadImage("result", result.picture);
    commands.uploadImage("surfaces", result.surfaces);
    const std::vector<float>& met = result.surfaces.values;
    commands.report("surfaces", std::accumulate(met.begin(), met.end(), 0.0));
    commands.report("most surfaces", *std::max_element(met.begin(), met.end()));
}

} // namespace kestrel
