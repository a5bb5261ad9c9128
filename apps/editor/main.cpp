// kestrel-editor: views, edits and compares graphs in a window.
#include "core/files.h"
#include "freed_memory.h"
#include "named.h"
#include "window.h"
#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace {

using namespace kestrel;

struct Arguments {
    std::string graph, scene;
    std::string size = "640x360";
    float scale = 1;
    bool light = false;
};

int run(const Arguments& arguments) {
    Registry& registry = loadedRegistry();
    Graph graph;
    if (!arguments.graph.empty()) graph = loadGraph(graphFile(arguments.graph));
    edit::SessionOptions options;
    options.size = parseSize(arguments.size);
    options.scene = arguments.scene;
    edit::Theme theme;
    theme.scale = arguments.scale;
    theme.dark = !arguments.light;
    edit::Window window({1600, 900, 1}, theme);
    edit::Session session(registry, window.context().capabilities(), window.context().driver(),
                          std::move(graph), options);
    edit::Plugins plugins(registry, pluginFolders());
    edit::Editor editor(session, theme);
    editor.plugins = &plugins;
    window.run(editor, theme);
    return static_cast<int>(ExitStatus::Done);
}

} // namespace

int main(int argc, char** argv) {
    keepFreedMemory();
    CLI::App app("Views, edits and compares Kestrel's graphs");
    Arguments arguments;
    app.add_option("GRAPH", arguments.graph, "Graph file, or the name of one that comes with Kestrel");
    app.add_option("--scene,-s", arguments.scene, "Scene in place of the graph's");
    app.add_option("--size", arguments.size, "Size of the picture, WIDTHxHEIGHT")->capture_default_str();
    app.add_option("--scale", arguments.scale, "Of text and widgets")
        ->check(CLI::Range(0.6, 3.0))
        ->capture_default_str();
    app.add_flag("--light", arguments.light, "Dark text on light");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : static_cast<int>(ExitStatus::BadInput);
    }
    try {
        return run(arguments);
    } catch (const Error& error) {
        for (const Problem& problem : error.problems())
            fmt::print(stderr, "kestrel-editor: {}\n", problem.text());
        return static_cast<int>(error.status());
    }
}
