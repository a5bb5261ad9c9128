#include "common.h"
#include "core/files.h"
#include "core/log.h"
#include "plugin/loader.h"
#include "scene/geometry.h"
#include <charconv>
#include <fmt/format.h>

namespace kestrel {

void addGraphArguments(CLI::App& command, GraphArguments& arguments) {
    command.add_option("GRAPH", arguments.graph, "Graph file (.json)")->required();
    command.add_option(
        "--scene,-s", arguments.scene,
        "Scene: a .gltf or .glb file, or builtin:NAME (see 'kestrel scene list'); default: the "
        "graph's");
    command.add_option("--camera,-c", arguments.camera,
                       "Camera of the scene by its name or its number, from 0 (see 'kestrel scene info'); "
                       "default: the graph's, else the first");
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

const Registry& loadedRegistry() {
    // Passes refer to their types until the process ends.
    static const Registry registry = [] {
        Registry loaded;
        loadPlugins(loaded, pluginFolders());
        return loaded;
    }();
    return registry;
}

Graph openGraph(const GraphArguments& arguments, const Registry& registry) {
    Graph graph = loadGraph(arguments.graph);
    std::vector<Problem> problems;
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
    if (!arguments.scene.empty()) return openScene(arguments.scene, arguments.sceneOptions);
    if (graph.sceneSource.empty())
        throw InputError(Location{arguments.graph}, "the graph names no scene: give one with --scene");
    Scene scene = loadScene(graph.sceneSource, graph.file.parent_path(), arguments.sceneOptions);
    for (const std::string& warning : scene.warnings) logWarning("{}: {}", scene.name, warning);
    return scene;
}

Scene openScene(const std::string& source, const SceneOptions& options) {
    Scene scene = loadScene(source, {}, options);
    for (const std::string& warning : scene.warnings) logWarning("{}: {}", scene.name, warning);
    return scene;
}

Extent parseSize(const std::string& text) {
    const auto side = [](const char* begin, const char* end) -> std::uint32_t {
        std::uint32_t value = 0;
        const auto [rest, failure] = std::from_chars(begin, end, value);
        return failure == std::errc() && rest == end && value <= 16384 ? value : 0;
    };
    const size_t cross = text.find('x');
    const char* begin = text.data();
    const char* end = begin + text.size();
    const Extent size{cross == std::string::npos ? 0 : side(begin, begin + cross),
                      cross == std::string::npos ? 0 : side(begin + cross + 1, end), 1};
    if (size.width == 0 || size.height == 0)
        throw InputError(fmt::format("--size {}: it must be WIDTHxHEIGHT with 1 to 16384 each", text));
    return size;
}

PortRef parsePort(const std::string& text) {
    const auto port = parsePortRef(text);
    if (!port) throw InputError(fmt::format("'{}' is not of the form pass.port", text));
    return *port;
}

} // namespace kestrel
