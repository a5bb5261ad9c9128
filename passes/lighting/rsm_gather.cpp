#include "rsm_gather.h"
#include "draw/face_input.h"
#include "draw/no_light.h"

namespace kestrel {
namespace {

// Which lights the maps' producer mapped: with directional and area lights or without, by the size of its
// block.
std::optional<LightMapLayout> layoutOf(const SceneFacts& facts, const Desc& block) {
    for (const bool area : {true, false})
        for (const bool directional : {false, true}) {
            LightMapLayout layout = lightMapLayout(facts, {true, true, directional, area, area}, true);
            if (layout.lights() > 0 && layout.blockBytes() == block.bytes) return layout;
        }
    return {};
}

} // namespace

PassType RsmGather::type() {
    Describe<RsmGather> table("RsmGather",
                              "Indirect light gathered from reflective shadow maps, without visibility");
    return addSurface(table)
        .input("maps", PortKind::Buffer, "How the maps lie, and the lights")
        .carries(content::elements("LightMap"))
        .input("map_radiance", PortKind::Texture, "Radiance reflected at the maps' texels")
        .carries(content::colour)
        .input("map_normal", PortKind::Texture, "Normals there, and the planes' distances")
        .carries({.channels = 4, .space = Space::Render})
        .sameExtentAs("map_radiance")
        .input("map_position", PortKind::Texture, "Positions there")
        .carries(content::position)
        .sameExtentAs("map_radiance")
        .output("result", PortKind::Texture,
                "Cosine-weighted mean of the radiance that arrives (irradiance over pi); 0 where nothing is")
        .carries(content::colour)
        .range(0, 1e30)
        .number("samples", &RsmGather::samples, 1, 512, "texels", "Asked of each light, a pixel and frame")
        .number(
            "radius", &RsmGather::radius, 0.001, 4, "map widths",
            "Of the disk around the pixel's own place that samples are drawn from; 1 is all of a light's map")
        .flag("rotate", &RsmGather::rotate,
              "Other samples for each pixel and frame; otherwise the same for all of them");
}

Declaration RsmGather::declare(const World& world, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Desc& depth = inputs["depth"].desc;
    Output result{.port = "result", .desc = Desc::texture2D(Format::RGBA32F, depth.extent, depth.view)};
    const std::optional<LightMapLayout> layout = layoutOf(world.facts, inputs["maps"].desc);
    if (!layout || inputs["map_radiance"].constant || inputs["depth"].constant) {
        if (!layout && !inputs["map_radiance"].constant &&
            world.facts.pointLights + world.facts.spotLights > 0)
            declaration.problems.push_back({"maps", "does not hold the maps of this scene's lights"});
        result.constant = noLight;
        declaration.outputs.push_back(std::move(result));
        declaration.leftOut.push_back(
            {"gathering", inputs["depth"].constant ? "there is nothing in view" : "no light has a map"});
        return declaration;
    }
    declaration.outputs.push_back(std::move(result));
    Step step{.name = "gather",
              .shaders = {"lighting/rsm_gather.comp"},
              .defines = layout->defines(),
              .uses = {{.port = "depth", .access = Access::Fetch},
                       {.port = "normal", .access = Access::Fetch},
                       {.port = "maps", .access = Access::Uniform},
                       {.port = "map_radiance", .access = Access::Image},
                       {.port = "map_normal", .access = Access::Image},
                       {.port = "map_position", .access = Access::Image},
                       {.port = "result", .access = Access::Image, .write = true}},
              .group = "gathering"};
    useFaceNormal(declaration, step, inputs);
    step.defines["SAMPLES"] = std::to_string(samples);
    if (rotate) {
        step.defines.emplace("ROTATE", "1");
        declaration.depends |= Causes::Frame;
    }
    declaration.steps.push_back(std::move(step));
    declaration.depends |= Causes::Properties;
    return declaration;
}

void RsmGather::execute(const Step&, Commands& commands) {
    commands.set("radius", radius);
    commands.dispatchOver(commands.desc("result").extent);
}

} // namespace kestrel
