#include "reflective_shadow_map.h"
#include <algorithm>

namespace kestrel {
namespace {

// The arrays that are drawn: their define switches the writing on in light_map.frag.
struct MapTarget {
    const char* port;
    const char* define;
    Format format;
    bool lookedUp; // by the module
    Content content;
    const char* description;
};

const MapTarget mapTargets[] = {
    {"map_radiance", "OUT_RADIANCE", Format::RGBA16F, true, content::colour,
     "Radiance that the surface reflects diffusely: albedo / pi times irradiance; 0 where nothing is"},
    {"map_normal",
     "OUT_NORMAL",
     Format::RGBA32F,
     true,
     {.channels = 4, .space = Space::Render},
     "Normal of the triangle, unit, towards the light, render space; w: the plane's distance from the map's "
     "origin along it (not positive). 0 where nothing is"},
    {"map_position", "OUT_POSITION", Format::RGBA32F, false, content::position,
     "Render-space position; w is 1 where something is"},
};

} // namespace

PassType ReflectiveShadowMap::type() {
    Describe<ReflectiveShadowMap> table("ReflectiveShadowMap",
                                        "What lights see, with the light that is reflected there");
    table.output("radiance", PortKind::Radiance,
                 "Light of the maps that leaves a hit, one diffuse reflection; needs positions only");
    for (const MapTarget& target : mapTargets)
        table.output(target.port, PortKind::Texture, target.description).carries(target.content);
    table.output("map_depth", PortKind::Texture, "Reversed depth of the maps")
        .carries(content::depth)
        .output("maps", PortKind::Buffer, "How the maps lie (shared/light_map.h), and the lights")
        .carries(content::elements("LightMap"))
        .number("resolution", &ReflectiveShadowMap::resolution, 16, 8192, "texels",
                "Width of a map; a point or sphere light has six, a rectangle five")
        .flag("area_lights", &ReflectiveShadowMap::areaLights,
              "Maps rectangles and spheres too, as seen from their middle")
        .flag("directional", &ReflectiveShadowMap::directional, "Maps directional lights too")
        .flag("jitter", &ReflectiveShadowMap::jitter,
              "Displaces the maps by parts of a texel, differently every frame")
        .number("position_jitter", &ReflectiveShadowMap::positionJitter, 0, 0.1, "scene radii",
                "Displaces the places that maps are seen from by up to this, differently every frame (radii "
                "of what "
                "the camera sees from near where the scene is far wider)")
        .number("bias", &ReflectiveShadowMap::bias, 0, 16, "texels",
                "How far off a texel's surface a hit may lie, besides the hit's own error");
    return table;
}

LightMapLayout ReflectiveShadowMap::layout(const SceneFacts& facts, bool follows) const {
    LightMapLayout maps = lightMapLayout(facts, {true, true, directional, areaLights, areaLights}, true);
    maps.follows = follows;
    return maps;
}

Declaration ReflectiveShadowMap::declare(const World& world, const Inputs&, const Demand& demand) const {
    Declaration declaration;
    // Whether a sun's map covers the scene or follows the camera is known when a frame's camera is.
    const LightMapLayout maps = layout(world.facts, demand.grown("maps") > 0);
    const bool dark = maps.lights() == 0 || world.facts.triangles == 0;
    declaration.outputs = {{.port = "radiance", .desc = Desc::module(0)}};
    Module module{.port = "radiance",
                  .shader = "lighting/reflective_shadow_map.glsl",
                  .defines = dark ? Defines{{"LIGHTS", "0"}} : maps.defines()};

    const bool traced = demand.reads("radiance");
    const auto wanted = [&](const MapTarget& target) {
        return (traced && target.lookedUp) || demand.reads(target.port);
    };
    int bytes = formatInfo(Format::D32F).bytes;
    for (const MapTarget& target : mapTargets)
        if (wanted(target)) bytes += formatInfo(target.format).bytes;
    const int made = lightMapResolution(maps, resolution, bytes);
    // Without a light the arrays are one black texel.
    const auto side = static_cast<std::uint32_t>(dark ? 1 : made);
    const Extent extent{side, side, std::max(1u, dark ? 1u : maps.layers)};
    Step draw = lightMapStep("draw", world, maps);
    for (const MapTarget& target : mapTargets) {
        if (!wanted(target)) continue;
        Output output{.port = target.port, .desc = Desc::array2D(target.format, extent)};
        if (dark)
            output.constant = glm::vec4(0);
        else
            output.clear = glm::vec4(0);
        declaration.outputs.push_back(std::move(output));
        draw.defines.emplace(target.define, "1");
        draw.uses.push_back({.port = target.port, .access = Access::Attachment, .write = true});
        if (traced && target.lookedUp) module.uses.push_back({.port = target.port, .access = Access::Fetch});
    }
    Output depth{.port = "map_depth", .desc = Desc::array2D(Format::D32F, extent)};
    Output block{.port = "maps", .desc = Desc::buffer(std::max<std::uint64_t>(maps.blockBytes(), 16))};
    if (dark) {
        module.uses.clear();
        depth.constant = block.constant = glm::vec4(0);
        declaration.outputs.push_back(std::move(depth));
        declaration.outputs.push_back(std::move(block));
        declaration.modules.push_back(std::move(module));
        declaration.leftOut.push_back({"maps", world.facts.triangles == 0
                                                   ? "the scene has no triangle"
                                                   : "the scene has no light that is mapped"});
        return declaration;
    }
    declaration.leftOut = lightMapShortage(maps, resolution, bytes);
    depth.clear = glm::vec4(0);
    declaration.outputs.push_back(std::move(depth));
    declaration.outputs.push_back(std::move(block));
    module.uses.push_back({.port = "maps", .access = Access::Uniform});
    module.defines.emplace("RESOLUTION", std::to_string(made));
    draw.uses.push_back({.port = "map_depth", .access = Access::Attachment, .write = true});
    declaration.modules.push_back(std::move(module));
    declaration.steps = {{.name = "views",
                          .run = {&ReflectiveShadowMap::uploadViews, bytes, maps.follows},
                          .uses = {{.port = "maps", .access = Access::Copy, .write = true}},
                          .group = "generation"},
                         std::move(draw)};

    if (world.facts.pointLights == 0) declaration.leftOut.push_back({"point lights", "the scene has none"});
    if (world.facts.spotLights == 0) declaration.leftOut.push_back({"spot lights", "the scene has none"});
    if (world.facts.directionalLights > 0 && !directional)
        declaration.leftOut.push_back({"directional lights", "they were not asked for"});
    if (!areaLights && world.facts.rectangleLights + world.facts.sphereLights > 0)
        declaration.leftOut.push_back({"area lights", "they were not asked for"});
    if (!world.facts.hasMasked)
        declaration.leftOut.push_back({"alpha test", "no material is masked or blended"});
    declaration.depends =
        Causes::Geometry | Causes::Transforms | Causes::Materials | Causes::Lights | Causes::Properties;
    if (directional && world.facts.directionalLights > 0) declaration.depends |= Causes::Cut;
    if (maps.follows) declaration.depends |= Causes::Camera;
    if (jitter || positionJitter > 0) declaration.depends |= Causes::Frame;
    return declaration;
}

void ReflectiveShadowMap::uploadViews(Commands& commands, int bytes, bool follows) {
    const LightMapLayout maps = layout(commands.facts(), follows);
    if (directional && !follows && nestedMaps(commands.facts(), commands.frame().cameraState) > 0)
        return commands.overflow("maps", 1);
    warnOfShortage(lightMapShortage(maps, resolution, bytes), told_);
    commands.upload("maps", lightMapBlock(maps, commands.lights(), commands.facts(),
                                          lightMapResolution(maps, resolution, bytes), bias,
                                          {jitter, positionJitter}, commands.frame()));
}

} // namespace kestrel
