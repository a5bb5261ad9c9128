// `kestrel scene`: the built-in scenes, the facts of any scene, and export as .glb.
#include "commands.h"
#include "common.h"
#include "scene/builtin.h"
#include "scene/facts.h"
#include "scene/gltf_export.h"
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>
#include <nlohmann/json.hpp>

namespace kestrel {

namespace {

using OrderedJson = nlohmann::ordered_json;

void printJson(const OrderedJson& json) {
    fmt::print("{}\n", json.dump(2, ' ', false, OrderedJson::error_handler_t::replace));
}

int listScenes(bool json) {
    OrderedJson all = OrderedJson::array();
    for (const BuiltinInfo& info : builtinInfos()) {
        all.push_back({{"name", "builtin:" + info.name}, {"description", info.description}});
        if (!json) fmt::print("builtin:{:<10} {}\n", info.name, info.description);
    }
    if (json) printJson({{"scenes", all}});
    return 0;
}

// Numbers and yes-or-no facts by name, in one order for people and machines.
OrderedJson factsJson(const SceneFacts& f) {
    return {{"triangles", f.triangles},
            {"vertices", f.vertices},
            {"materials", f.materials},
            {"images", f.images},
            {"instances", f.instances},
            {"masked_triangles", f.maskedTriangles},
            {"masked", f.hasMasked},
            {"blend", f.hasBlend},
            {"double_sided", f.hasDoubleSided},
            {"single_sided", f.hasSingleSided},
            {"textures", f.hasTextures},
            {"normal_maps", f.hasNormalMaps},
            {"vertex_colours", f.hasVertexColours},
            {"emission", f.hasEmission},
            {"transmission", f.hasTransmission},
            {"unlit", f.hasUnlit},
            {"geometry_moves", f.geometryMoves},
            {"geometry_deforms", f.geometryDeforms},
            {"camera_moves", f.cameraMoves},
            {"lights_move", f.lightsMove},
            {"point_lights", f.pointLights},
            {"spot_lights", f.spotLights},
            {"directional_lights", f.directionalLights},
            {"rectangle_lights", f.rectangleLights},
            {"sphere_lights", f.sphereLights},
            {"duration", f.duration},
            {"radius", f.sphere.radius}};
}

int tellScene(const std::string& source, const SceneOptions& options, bool json) {
    const Scene scene = openScene(source, options);
    const SceneFacts facts = gatherFacts(scene);
    std::vector<std::string> cameras;
    for (const Camera& camera : scene.cameras) cameras.push_back(camera.name);
    std::vector<std::string> animations, lights;
    for (const Animation& animation : scene.animations) animations.push_back(animation.name);
    for (const Light& light : scene.lights) lights.push_back(light.name);
    const OrderedJson values = factsJson(facts);
    if (json) {
        printJson({{"name", scene.name},
                   {"cameras", cameras},
                   {"animations", animations},
                   {"lights", lights},
                   {"facts", values},
                   {"warnings", scene.warnings}});
        return 0;
    }
    fmt::print("{}\ncameras: {}\nanimations: {}\n", scene.name, fmt::join(cameras, ", "),
               fmt::join(animations, ", "));
    for (const auto& [name, value] : values.items())
        fmt::print("{}: {}\n", name, value.is_boolean() ? (value.get<bool>() ? "yes" : "no") : value.dump());
    return 0;
}

int exportTo(const std::string& source, const SceneOptions& options, const std::string& file) {
    if (std::filesystem::path(file).extension() != ".glb")
        throw InputError(fmt::format("{}: scenes are written as .glb", file));
    exportScene(openScene(source, options), file);
    say("{}\n", file);
    return 0;
}

} // namespace

void addSceneCommand(CLI::App& app, Run& run) {
    struct Arguments {
        std::string source, file;
        SceneOptions options;
        bool json = false;
    };
    const auto arguments = std::make_shared<Arguments>();
    CLI::App* scene =
        app.add_subcommand("scene", "List the built-in scenes, tell a scene's facts, export it");
    scene->require_subcommand(1);
    const char* sourceHelp = "A .gltf or .glb file, builtin:NAME, or builtin:NAME?detail=0.1&split=4";

    CLI::App* list = scene->add_subcommand("list", "List the built-in scenes");
    list->add_flag("--json", arguments->json, "Print JSON");
    list->callback([arguments, &run] { run = [arguments] { return listScenes(arguments->json); }; });

    CLI::App* info = scene->add_subcommand("info", "Tell what holds for a scene over its whole timeline");
    info->add_option("SCENE", arguments->source, sourceHelp)->required();
    info->add_flag("--json", arguments->json, "Print JSON");
    addAllowOutside(*info, arguments->options.allowOutside);
    info->callback([arguments, &run] {
        run = [arguments] { return tellScene(arguments->source, arguments->options, arguments->json); };
    });

    CLI::App* exported = scene->add_subcommand("export", "Write a scene as .glb");
    exported->add_option("SCENE", arguments->source, sourceHelp)->required();
    exported->add_option("FILE", arguments->file, "The .glb file to write")->required();
    addAllowOutside(*exported, arguments->options.allowOutside);
    exported->callback([arguments, &run] {
        run = [arguments] { return exportTo(arguments->source, arguments->options, arguments->file); };
    });
    scene->footer(
        std::string(
            "Built-in scenes have three properties, as in 'builtin:tower?detail=0.1&split=4' (in quotes: '?' "
            "and\n"
            "'&' mean something to a shell): detail, 0.01 to 4, scales the number of triangles; split, 1 to "
            "64,\n"
            "cuts each triangle into that number squared: the same surface in more triangles; extent, 1\n"
            "to 1000, makes the scene the middle of one so many times larger.\n\n"
            "What a scene lacks can be added, by --camera and --light of render, check and sweep's scenes, "
            "as\n"
            "'key=value key=value' or as a JSON object. A camera has the keys\n") +
        cameraKeysText() + "and a light, whose kind comes first,\n" + lightKeysText() +
        "A camera's path, as a file: {\"kestrel_camera\": 1, \"target\": [0, 1, 0], \"keys\": [{\"time\": "
        "0,\n"
        "\"eye\": [4, 2, 0]}, {\"time\": 2, \"eye\": [0, 2, 4]}]}; --camera path=FILE.json takes it.\n\n"
        "Examples:\n"
        "  kestrel scene list\n"
        "  kestrel scene info model.glb --json\n"
        "  kestrel scene info 'builtin:blob?detail=0.0127&split=22'\n"
        "  kestrel scene export builtin:tower tower.glb");
}

} // namespace kestrel
