// What several commands share: opening the graph and the scene that the command line names.
#pragma once
#include "graph/graph.h"
#include "graph/plan.h"
#include "scene/scene.h"
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace kestrel {

// The options that say which graph runs on which scene.
struct GraphArguments {
    std::string graph, scene, camera, size = "640x360";
    std::vector<std::string> settings;
    SceneOptions sceneOptions;
};

// Adds GRAPH, --scene, --camera, --size, --set and --allow-outside to a command.
void addGraphArguments(CLI::App& command, GraphArguments& arguments);

// Adds --allow-outside to a command that loads scenes.
void addAllowOutside(CLI::App& command, bool& allowOutside);

// All pass types of the plugins that are there. A plugin that can't be used is told and skipped.
const Registry& loadedRegistry();

// The graph with the settings applied. Throws InputError with everything that is wrong with it.
Graph openGraph(const GraphArguments& arguments, const Registry& registry);
// The scene of the command line, else the graph's (relative to the graph's folder). Its warnings are told.
Scene openScene(const GraphArguments& arguments, const Graph& graph);
// Of a scene alone, relative to the working folder.
Scene openScene(const std::string& source, const SceneOptions& options);

// "640x360". Throws InputError for anything else, for 0 and for sides above 16384.
Extent parseSize(const std::string& text);
// "pass.port". Throws InputError for anything else.
PortRef parsePort(const std::string& text);

} // namespace kestrel
