// What the editor's own frame costs beside the graph, by the number of nodes. Run by hand, where there is a
// display (or Xvfb): build/bin/benchmark_editor_frame. Three parts: what the processor does until there is
// something to draw (as a GPU leaves it), the drawing (here by the driver on the processor), and a second at
// rest.
#include "editor.h"
#include "named.h"
#include "window.h"
#include <algorithm>
#include <chrono>
#include <ctime>
#include <fmt/format.h>
#include <imgui.h>

namespace {

using namespace kestrel;

double milliseconds() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}
double processorSeconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

double median(std::vector<double> series) {
    std::sort(series.begin(), series.end());
    return series.at(series.size() / 2);
}

// A chain of blurs, of which each but the first reads the one before and the G-buffer, in rows of ten.
Graph graphOf(int nodes) {
    Graph graph;
    graph.sceneSource = "builtin:blob?detail=0.02";
    const auto add = [&](const std::string& name, const char* type, int i) {
        GraphPass pass;
        pass.name = name;
        pass.type = type;
        pass.position = glm::dvec2(220 * (i % 10), 160 * (i / 10));
        graph.passes.push_back(std::move(pass));
    };
    add("gbuffer", "GBuffer", 0);
    PortRef from{"gbuffer", "view_depth"};
    for (int i = 1; i < nodes; ++i) {
        const std::string name = fmt::format("blur_{}", i);
        add(name, "BilateralBlur", i);
        graph.edges.push_back({from, {name, "signal"}, {}});
        graph.edges.push_back({{"gbuffer", "view_depth"}, {name, "view_depth"}, {}});
        from = {name, "result"};
    }
    // Nothing but the G-buffer is made: it is the editor that is measured.
    graph.outputs.push_back({{"gbuffer", "view_depth"}, {}});
    return graph;
}

void measure(edit::Window& window, edit::Theme& theme, int nodes) {
    edit::SessionOptions options;
    options.size = {64, 36, 1};
    edit::Session session(loadedRegistry(), window.context().capabilities(), window.context().driver(),
                          graphOf(nodes), options);
    edit::Editor editor(session, theme, "/tmp/kestrel-benchmark-state");
    editor.stopAfter = 1;
    const auto frame = [&] {
        window.frame(editor, theme, {});
        window.context().present();
    };
    for (int i = 0; i < 20; ++i) frame();
    editor.canvas.frameAll(session);
    for (int i = 0; i < 20; ++i) frame();
    std::vector<double> own, whole;
    for (int i = 0; i < 120; ++i) {
        const double begin = milliseconds();
        frame();
        whole.push_back(milliseconds() - begin);
        own.push_back(window.ownMs());
    }
    // As the program's loop has it: it sleeps until something happens.
    const double begin = milliseconds(), processor = processorSeconds();
    window.runFor(editor, theme, 5);
    const double used = processorSeconds() - processor, took = (milliseconds() - begin) / 1000;
    fmt::print(
        "{} nodes: own frame {:.2f} ms, with drawing and showing {:.2f} ms; at rest {:.2f} % of a core\n",
        nodes, median(own), median(whole), 100 * used / took);
}

} // namespace

int main() {
    try {
        edit::Theme theme;
        edit::Window window({1600, 900, 1}, theme);
        for (const int nodes : {1, 60, 500}) measure(window, theme, nodes);
        return 0;
    } catch (const Error& error) {
        for (const Problem& problem : error.problems()) fmt::print(stderr, "{}\n", problem.text());
        return static_cast<int>(error.status());
    }
}
