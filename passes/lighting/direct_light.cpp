#include "direct_light.h"
#include "draw/face_input.h"
#include "draw/no_light.h"
#include <algorithm>

namespace kestrel {
namespace {

const std::vector<Use> shadowedLights = {{.port = "maps", .access = Access::Uniform},
                                         {.port = "shadow_maps", .access = Access::Fetch}};

const int texelBytes = formatInfo(Format::D32F).bytes;

void noteLeftOutKinds(const SceneFacts& facts, std::vector<LeftOut>& leftOut) {
    const std::pair<std::uint32_t, const char*> kinds[] = {{facts.pointLights, "point lights"},
                                                           {facts.spotLights, "spot lights"},
                                                           {facts.directionalLights, "directional lights"},
                                                           {facts.rectangleLights, "rectangle lights"},
                                                           {facts.sphereLights, "sphere lights"}};
    for (const auto& [count, what] : kinds)
        if (count == 0) leftOut.push_back({what, "the scene has none"});
}

} // namespace

PassType DirectLight::type() {
    Describe<DirectLight> table("DirectLight", "Light straight from the scene's lights, through shadow maps");
    return addSurface(table)
        .optionalInput("albedo", PortKind::Texture, "Their linear base colour, for specular")
        .carries(content::colour)
        .sameExtentAs("depth")
        .optionalInput("material", PortKind::Texture, "Their roughness and metallic, for specular")
        .carries(content::material)
        .sameExtentAs("depth")
        .output("result", PortKind::Texture, "Irradiance over pi; 0 where nothing is")
        .carries(content::colour)
        .range(0, 1e30)
        .output(
            "specular", PortKind::Texture,
            "Radiance reflected specularly towards the eye from point, spot and directional lights; needs "
            "albedo and material")
        .carries(content::colour)
        .range(0, 1e30)
        .output("radiance", PortKind::Radiance,
                "Light of the lights that leaves a hit diffusely, its emission, and with `highlights` those; "
                "needs its material")
        .output("shadow_maps", PortKind::Texture, "Reversed depth that each light sees, layer by layer")
        .carries(content::depth)
        .internal("maps", PortKind::Buffer, "How the maps lie (shared/light_map.h), and the lights")
        .number("resolution", &DirectLight::resolution, 16, 8192, "texels",
                "Width of a shadow map; a point or sphere light has six, a rectangle five")
        .flag("shadows", &DirectLight::shadows, "Without them light passes through everything")
        .choice("filter", &DirectLight::filter, {"nearest", "two", "four"},
                "Texels compared along each axis: the nearest, two weighted by distance, or a box of three")
        .number("bias", &DirectLight::bias, 0, 16, "",
                "Factor on the offset along the normal that keeps a plane from shadowing itself")
        .flag("emission", &DirectLight::emission,
              "The module adds what surfaces emit; off where area lights stand for the meshes that glow")
        .flag("highlights", &DirectLight::highlights,
              "The module adds what point, spot and directional lights reflect specularly")
        .flag("area_lights", &DirectLight::areaLights,
              "Rectangles and spheres too (shadowed from their middle); off where another pass samples them");
}

LightMapLayout DirectLight::layout(const SceneFacts& facts, std::uint32_t nested) const {
    return lightMapLayout(facts, {true, true, true, areaLights, areaLights}, shadows && facts.triangles > 0,
                          nested);
}

Defines DirectLight::lightDefines(const LightMapLayout& maps) const {
    Defines defines = maps.defines();
    if (maps.mapped) {
        defines.emplace("SHADOWS", "1");
        defines.emplace("SHADOW_TAPS", filter == Filter::Nearest ? "1" : filter == Filter::Two ? "2" : "4");
    }
    return defines;
}

Declaration DirectLight::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    // How many smaller maps a sun needs is known when a frame's camera is.
    const LightMapLayout maps = layout(world.facts, static_cast<std::uint32_t>(demand.grown("maps")));
    const bool dark = maps.lights() == 0;
    if (!dark) {
        declaration.leftOut = lightMapShortage(maps, resolution, texelBytes);
        declaration.outputs.push_back({.port = "maps", .desc = Desc::buffer(maps.blockBytes())});
        declaration.steps.push_back({.name = "views",
                                     .run = {&DirectLight::uploadViews, maps},
                                     .uses = {{.port = "maps", .access = Access::Copy, .write = true}},
                                     .group = "generation"});
    }
    // Without shadows the array is one lit texel.
    const bool mapped = !dark && maps.mapped;
    const auto side =
        static_cast<std::uint32_t>(mapped ? lightMapResolution(maps, resolution, texelBytes) : 1);
    Output shadowMaps{.port = "shadow_maps",
                      .desc =
                          Desc::array2D(Format::D32F, {side, side, std::max(1u, mapped ? maps.layers : 1u)})};
    if (mapped) {
        shadowMaps.clear = glm::vec4(0);
        Step draw = lightMapStep("shadows", world, maps);
        draw.defines.emplace("SHADOW", "1");
        draw.uses.push_back({.port = "shadow_maps", .access = Access::Attachment, .write = true});
        declaration.steps.push_back(std::move(draw));
    } else {
        shadowMaps.constant = glm::vec4(0);
    }
    declaration.outputs.push_back(std::move(shadowMaps));

    declareShading(world, inputs, demand, maps, declaration);
    declareModule(world, maps, declaration);
    if (dark)
        declaration.leftOut.push_back(
            {"lights", world.facts.lights() == 0 ? "the scene has none" : "the scene has area lights only"});
    else
        noteLeftOutKinds(world.facts, declaration.leftOut);
    if (!areaLights && world.facts.rectangleLights + world.facts.sphereLights > 0)
        declaration.leftOut.push_back({"area lights", "they were not asked for"});
    if (!dark && !mapped)
        declaration.leftOut.push_back(
            {"shadow maps", world.facts.triangles == 0 ? "the scene has no triangle" : "shadows are off"});
    declaration.depends = Causes::Lights | Causes::Properties;
    if (mapped) declaration.depends |= Causes::Geometry | Causes::Transforms;
    if (mapped && world.facts.directionalLights > 0) declaration.depends |= Causes::Cut;
    if (mapped && maps.nested > 0) declaration.depends |= Causes::Camera;
    if (mapped && world.facts.hasMasked) declaration.depends |= Causes::Materials;
    return declaration;
}

void DirectLight::declareShading(const World& world, const Inputs& inputs, const Demand& demand,
                                 const LightMapLayout& maps, Declaration& declaration) const {
    const Desc& depth = inputs["depth"].desc;
    const Desc texture = Desc::texture2D(Format::RGBA32F, depth.extent, depth.view);
    const bool glossy = inputs.connected("albedo") && inputs.connected("material");
    const bool dark =
        maps.lights() == 0 || inputs["depth"].constant == glm::vec4(0) || world.facts.triangles == 0;
    Step shade{
        .name = "shade",
        .run = [extent = depth.extent](Commands& commands) { commands.dispatchOver(extent); },
        .shaders = {"lighting/direct_light.comp"},
        .defines = lightDefines(maps),
        .uses = {{.port = "depth", .access = Access::Fetch}, {.port = "normal", .access = Access::Fetch}},
        .group = "shading"};
    const auto add = [&](const char* port, const char* define, bool lit) {
        Output output{.port = port, .desc = texture};
        if (!lit) output.constant = noLight;
        declaration.outputs.push_back(std::move(output));
        if (!lit || !demand.reads(port)) return;
        shade.defines.emplace(define, "1");
        shade.uses.push_back({.port = port, .access = Access::Image, .write = true});
    };
    add("result", "OUT_RESULT", !dark);
    const bool punctual =
        world.facts.pointLights + world.facts.spotLights + world.facts.directionalLights > 0;
    if (glossy) {
        add("specular", "OUT_SPECULAR", !dark && punctual);
        if (shade.defines.contains("OUT_SPECULAR")) {
            shade.uses.push_back({.port = "albedo", .access = Access::Fetch});
            shade.uses.push_back({.port = "material", .access = Access::Fetch});
            if (world.facts.rectangleLights + world.facts.sphereLights > 0)
                declaration.leftOut.push_back(
                    {"highlights of area lights", "a reflection that is traced sees them"});
        }
        if (!dark && !punctual)
            declaration.leftOut.push_back({"specular", "the scene has no point, spot or directional light"});
    } else {
        declaration.leftOut.push_back({"specular", "albedo or material is not connected"});
    }
    if (!shade.defines.contains("OUT_RESULT") && !shade.defines.contains("OUT_SPECULAR")) return;
    useFaceNormal(declaration, shade, inputs);
    shade.uses.push_back(shadowedLights[0]);
    if (maps.mapped) shade.uses.push_back(shadowedLights[1]);
    declaration.steps.push_back(std::move(shade));
}

void DirectLight::declareModule(const World& world, const LightMapLayout& maps,
                                Declaration& declaration) const {
    Module module{.port = "radiance", .shader = "lighting/direct_light.glsl", .defines = lightDefines(maps)};
    const bool shines = emission && world.facts.hasEmission;
    if (shines) module.defines.emplace("EMISSION", "1");
    const SceneFacts& facts = world.facts;
    if (highlights && facts.pointLights + facts.spotLights + facts.directionalLights > 0)
        module.defines.emplace("HIGHLIGHTS", "1");
    if (maps.lights() > 0) {
        module.uses.push_back(shadowedLights[0]);
        if (maps.mapped) module.uses.push_back(shadowedLights[1]);
    }
    declaration.outputs.push_back(
        {.port = "radiance", .desc = Desc::module(0, shines || maps.lights() > 0 ? required::Surface : 0)});
    declaration.modules.push_back(std::move(module));
    if (emission && !world.facts.hasEmission)
        declaration.leftOut.push_back({"emission", "no material emits light"});
}

void DirectLight::uploadViews(Commands& commands, const LightMapLayout& maps) {
    const std::uint32_t nested = maps.mapped ? nestedMaps(commands.facts(), commands.frame().cameraState) : 0;
    if (nested > maps.nested) return commands.overflow("maps", nested);
    warnOfShortage(lightMapShortage(maps, resolution, texelBytes), told_);
    commands.upload("maps", lightMapBlock(maps, commands.lights(), commands.facts(),
                                          lightMapResolution(maps, resolution, texelBytes), bias, {},
                                          commands.frame()));
}

} // namespace kestrel
