// What several commands share: opening the graph and the scene that the command line names.
#pragma once
#include "graph/graph.h"
#include "graph/plan.h"
#include "named.h"
#include "say.h"
#include "scene/scene.h"
#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kestrel {

// A check of an option: that its text is not empty.
[[nodiscard]] CLI::Validator notEmpty();

// The options that say which graph runs on which scene.
struct GraphArguments {
    std::string graph, scene, camera, animation, size = "640x360";
    std::vector<std::string> lights, settings;
    std::optional<double> time, fps;
    SceneOptions sceneOptions;
};

// Adds GRAPH, --size, --set, and what says how the scene is set up, to a command.
void addGraphArguments(CLI::App& command, GraphArguments& arguments);

// Adds --allow-outside to a command that loads scenes.
void addAllowOutside(CLI::App& command, bool& allowOutside);

// The graph with the settings applied, and the scene's setup as the command line changes it. Throws
// InputError with everything that is wrong with it.
Graph openGraph(const GraphArguments& arguments, const Registry& registry);
// The scene of the command line, else the graph's (relative to the graph's folder), set up as the graph says.
// Its warnings are told.
Scene openScene(const GraphArguments& arguments, const Graph& graph);
// Of a scene alone, relative to the working folder.
Scene openScene(const std::string& source, const SceneOptions& options);

// Where a file that the command line names lies: absolute, "standard input", or as it is for a pipe.
std::string pathOf(const std::string& file);
// Of the scene that openScene() opens; "builtin:NAME" as it is.
std::string scenePath(const GraphArguments& arguments, const Graph& graph);

// Throws InputError naming both where what `option` writes would be GRAPH itself, or would from then on be
// taken for it: a graph that comes with Kestrel goes by its name only where no file has that name.
void requireNoGraph(const GraphArguments& arguments, const std::string& option,
                    const std::filesystem::path& file);

// "pass.port". Throws InputError for anything else.
PortRef parsePort(const std::string& text);

} // namespace kestrel
