#include "composite.h"
#include "dielectric_layer.h"
#include "execute/commands.h"
#include <fmt/format.h>
#include <limits>

namespace kestrel {
namespace {

struct Part {
    const char* port;
    const char* define;
    Content content;
    const char* description;
    float neutral; // a constant input of this value changes nothing and is left out
};

const Part compositeParts[] = {
    {"direct", "DIRECT", {}, "Direct light, irradiance over pi", 0},
    {"area", "AREA", {}, "Direct light of area lights with their shadows, irradiance over pi", 0},
    {"indirect", "INDIRECT", {}, "Indirect light, irradiance over pi", 0},
    {"visibility", "VISIBILITY", {}, "Ambient visibility: multiplies indirect and ambient light", 1},
    {"shadow", "SHADOWED", {}, "Visibility of the lights: multiplies the direct light", 1},
    {"specular", "SPECULAR", {}, "Radiance reflected specularly towards the eye", 0},
    {"reflection", "REFLECTION", {}, "More of it: what rays along the specular lobe bring", 0},
    {"emission", "EMISSION", {}, "Emitted radiance", 0},
    {"background", "BACKGROUND", {}, "Radiance where nothing is", 0},
    {"material", "MATERIAL", content::material,
     "Roughness, metallic, unlit: metals reflect nothing diffusely, the unlit shine", -1},
};

} // namespace

PassType Composite::type() {
    Describe<Composite> table("Composite", "Radiance that reaches the eye, from light and material");
    table.input("albedo", PortKind::Texture, "Linear base colour; a is 0 where nothing is")
        .carries(content::colour);
    for (const Part& part : compositeParts)
        table.optionalInput(part.port, PortKind::Texture, part.description)
            .carries(part.content)
            .sameExtentAs("albedo");
    table
        .optionalInput("depth", PortKind::Texture,
                       "Reversed depth: with normal and material, for the mix of layers")
        .carries(content::depth)
        .sameExtentAs("albedo")
        .optionalInput("normal", PortKind::Texture,
                       "Normals of the surfaces, unit, render space: the dielectric layer keeps part of the "
                       "diffuse light, "
                       "more of it as it is seen flatter (glTF 2.0, appendix B)")
        .carries(content::normal)
        .sameExtentAs("albedo")
        .internal("layer", PortKind::Buffer, "What the layer lets through, by cosine and roughness");
    table.output("result", PortKind::Texture, "Outgoing radiance; a is 1 where something is")
        .carries({.channels = 4})
        .range(0, std::numeric_limits<double>::infinity())
        .vector("ambient", &Composite::ambient, 0, 1e9, "radiance",
                "Light from all sides besides the inputs: albedo times this, darkened by visibility");
    return table;
}

Declaration Composite::declare(const World&, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Desc& albedo = inputs["albedo"].desc;
    declaration.outputs = {
        {.port = "result", .desc = Desc::texture2D(Format::RGBA32F, albedo.extent, albedo.view)}};
    Step step{.name = "composite",
              .run = &Composite::compose,
              .shaders = {"lighting/composite.comp"},
              .defines = {{"ALBEDO_FORMAT", std::string(formatInfo(albedo.format).name)}},
              .uses = {{.port = "albedo", .access = Access::Image},
                       {.port = "result", .access = Access::Image, .write = true}},
              .group = "composite"};
    if (ambient != glm::vec3(0)) step.defines.emplace("AMBIENT", "1");
    for (const Part& part : compositeParts) {
        if (!inputs.connected(part.port)) continue;
        const Inputs::Input& input = inputs[part.port];
        const FormatInfo& format = formatInfo(input.desc.format);
        if (format.integer)
            declaration.problems.push_back(
                {part.port, fmt::format("is no light: it is {}", describe(input.desc))});
        if (input.constant &&
            (format.channels == 1 ? input.constant->x == part.neutral
                                  : glm::vec3(*input.constant) == glm::vec3(part.neutral))) {
            declaration.leftOut.push_back({part.port, fmt::format("it is {} everywhere", part.neutral)});
            continue;
        }
        step.defines.emplace(part.define, format.channels == 1 ? "rrr" : "rgb"); // which components to read
        // By sampler: there may be more inputs than image units.
        step.uses.push_back({.port = part.port, .access = Access::Fetch});
    }
    if (step.defines.contains("MATERIAL") && inputs.connected("normal") && inputs.connected("depth")) {
        declaration.outputs.push_back(
            {.port = "layer",
             .desc = Desc::buffer(dielectricLayerTable().size() * sizeof(float), Format::R32F)});
        declaration.steps.push_back(
            {.name = "layer",
             .run = [](Commands& commands) { commands.upload("layer", dielectricLayerTable()); },
             .uses = {{.port = "layer", .access = Access::Copy, .write = true}},
             .group = "composite"});
        step.defines.emplace("LAYER_SIDE", std::to_string(dielectricLayerSide));
        for (const char* port : {"normal", "depth", "layer"})
            step.uses.push_back({.port = port, .access = Access::Fetch});
    } else if (inputs.connected("material")) {
        declaration.leftOut.push_back(
            {"mix of layers", "normal, depth or material is not connected, or nothing is there"});
    }
    declaration.steps.push_back(std::move(step));
    declaration.depends = Causes::Properties;
    return declaration;
}

void Composite::compose(Commands& commands) const {
    if (ambient != glm::vec3(0)) commands.set("ambient", ambient);
    commands.dispatchOver(commands.desc("result").extent);
}

} // namespace kestrel
