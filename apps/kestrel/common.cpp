#include "common.h"
#include "core/files.h"
#include "core/log.h"
#include "scene/geometry.h"
#include <fmt/format.h>

namespace kestrel {

CLI::Validator notEmpty() {
    return {
        [](std::string& text) { return text.empty() ? std::string("it must not be empty") : std::string(); },
        ""};
}

void addGraphArguments(CLI::App& command, GraphArguments& arguments) {
    command
        .add_option("GRAPH", arguments.graph,
                    "Graph file (.json), or the name of one that comes with Kestrel; - is standard input")
        ->required();
    command.add_option(
        "--scene,-s", arguments.scene,
        "Scene: a .gltf or .glb file, or builtin:NAME (see 'kestrel scene list'); default: the "
        "graph's");
    command.add_option(
        "--camera,-c", arguments.camera,
        "Camera of the scene by its name or its number, from 0 (see 'kestrel scene info'), or one of your "
        "own: 'eye=0,2,0 target=1,2,0 fov=60', 'path=FILE.json' (see 'kestrel scene --help'); default: the "
        "graph's, else the first");
    command
        .add_option("--light", arguments.lights,
                    "Adds a light: 'directional direction=0,-1,0 intensity=3' (see 'kestrel scene --help'); "
                    "may be given several times")
        ->allow_extra_args(false);
    command.add_option("--animation", arguments.animation,
                       "Which animation plays: its name or its number, none, or all; default: the graph's, "
                       "else all");
    command.add_option("--time", arguments.time, "The scene's time in the first frame, seconds; default: 0")
        ->check(CLI::Range(0.0, 1e6));
    command.add_option("--fps", arguments.fps, "Frames a second of the scene's time; default: 60")
        ->check(CLI::Range(1e-6, 1e6));
    command.add_option("--size", arguments.size, "Size of the frame in pixels, WIDTHxHEIGHT")
        ->capture_default_str();
    command
        .add_option(
            "--set", arguments.settings,
            "Changes the graph: pass.property=value, or pass.input=pass.output to move an edge; may be "
            "given several times")
        ->allow_extra_args(false);
    addAllowOutside(command, arguments.sceneOptions.allowOutside);
}

void addAllowOutside(CLI::App& command, bool& allowOutside) {
    command.add_flag("--allow-outside", allowOutside,
                     "Let a scene file name buffers and images outside its folder");
}

namespace {

// How the command line sets up the scene. Mistakes are noted.
SceneSetup setupOf(const GraphArguments& arguments, std::vector<Problem>& problems) {
    SceneSetup setup;
    const auto noting = [&](auto&& parse) {
        try {
            parse();
        } catch (const InputError& error) {
            problems.insert(problems.end(), error.problems().begin(), error.problems().end());
        }
    };
    if (describesCamera(arguments.camera))
        noting([&] { setup.camera = parseCamera(arguments.camera, "--camera"); });
    else
        setup.cameraName = arguments.camera;
    for (const std::string& light : arguments.lights)
        noting([&] { setup.lights.push_back(parseLight(light, "--light " + light)); });
    setup.animation = arguments.animation;
    setup.time = arguments.time;
    setup.fps = arguments.fps;
    return located(std::move(setup), std::filesystem::current_path());
}

} // namespace

Graph openGraph(const GraphArguments& arguments, const Registry& registry) {
    Graph graph = loadGraph(graphFile(arguments.graph));
    std::vector<Problem> problems;
    graph.sceneSetup =
        joined(located(std::move(graph.sceneSetup), graph.file.parent_path()), setupOf(arguments, problems));
    for (const std::string& setting : arguments.settings) try {
            applySetting(graph, registry, setting);
        } catch (const InputError& error) {
            problems.insert(problems.end(), error.problems().begin(), error.problems().end());
        }
    const std::vector<Problem> wrong = validate(graph, registry);
    problems.insert(problems.end(), wrong.begin(), wrong.end());
    if (!problems.empty()) throw InputError(std::move(problems));
    return graph;
}

Scene openScene(const GraphArguments& arguments, const Graph& graph) {
    const bool given = !arguments.scene.empty();
    if (!given && graph.sceneSource.empty())
        throw InputError(Location{arguments.graph}, "the graph names no scene: give one with --scene");
    Scene scene = loadScene(given ? arguments.scene : graph.sceneSource,
                            given ? std::filesystem::path() : graph.file.parent_path(),
                            arguments.sceneOptions, graph.sceneSetup);
    for (const std::string& warning : scene.warnings) logWarning("{}: {}", scene.name, warning);
    return scene;
}

Scene openScene(const std::string& source, const SceneOptions& options) {
    Scene scene = loadScene(source, {}, options);
    for (const std::string& warning : scene.warnings) logWarning("{}: {}", scene.name, warning);
    return scene;
}

std::string pathOf(const std::string& file) {
    if (file == "-") return "standard input";
    if (isStream(file)) return file;
    return std::filesystem::absolute(file).lexically_normal().string();
}

std::string scenePath(const GraphArguments& arguments, const Graph& graph) {
    const bool given = !arguments.scene.empty();
    const std::string& source = given ? arguments.scene : graph.sceneSource;
    if (source.starts_with("builtin:")) return source;
    return pathOf(given ? source : (graph.file.parent_path() / source).string());
}

void requireNoGraph(const GraphArguments& arguments, const std::string& option,
                    const std::filesystem::path& file) {
    if (file.empty() || isStream(file) || isStream(arguments.graph)) return;
    const auto whole = [](const std::filesystem::path& path) {
        return std::filesystem::weakly_canonical(std::filesystem::absolute(path));
    };
    const std::filesystem::path written = whole(file), graph = whole(graphFile(arguments.graph));
    if (written == graph)
        throw InputError(
            fmt::format("{} {} would be written over GRAPH {}, which is the same file: name another", option,
                        file.string(), arguments.graph));
    if (written == whole(arguments.graph))
        throw InputError(
            fmt::format("{} {} would from then on be taken for GRAPH {}, which is {}: name another", option,
                        file.string(), arguments.graph, graph.string()));
}

PortRef parsePort(const std::string& text) {
    const auto port = parsePortRef(text);
    if (!port) throw InputError(fmt::format("'{}' is not of the form pass.port", text));
    return *port;
}

} // namespace kestrel
