#include "studies/stress_curve.h"
#include "core/files.h"
#include "core/json.h"
#include "core/progress.h"
#include "measure/stress/curve_run.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel {
namespace {

bool isSweep(const std::filesystem::path& file) {
    return Json::parse(readText(file), file.string()).find("kestrel_sweep") != nullptr;
}

Sweep sweepOf(const GraphArguments& arguments, const CurveArguments& curve, const Registry& registry) {
    const std::filesystem::path file = graphFile(arguments.graph);
    Sweep sweep;
    if (isSweep(file)) {
        const bool own = !arguments.settings.empty() || !arguments.camera.empty() ||
                         !arguments.lights.empty() || !arguments.animation.empty() || arguments.time ||
                         arguments.fps;
        if (own)
            throw InputError(Location{arguments.graph},
                             "is a sweep: settings, cameras, lights and times are said in it");
        sweep = loadSweep(file);
        if (!arguments.scene.empty()) {
            const bool builtin = arguments.scene.starts_with("builtin:");
            sweep.scenes.assign(1, {});
            sweep.scenes.front().name = arguments.scene;
            sweep.scenes.front().source =
                builtin ? arguments.scene : std::filesystem::absolute(arguments.scene).string();
        }
        if (curve.sizeGiven) sweep.size = parseSize(arguments.size);
        if (curve.frames > 0) sweep.frames = curve.frames;
    } else {
        // With what the command line says of it, in a file of its own: variants name graphs.
        Graph graph = openGraph(arguments, registry);
        const std::string scene = scenePath(arguments, graph);
        if (scene.empty())
            throw InputError(Location{arguments.graph}, "the graph names no scene: give one with --scene");
        graph.sceneSetup = located(std::move(graph.sceneSetup), graph.file.parent_path());
        graph.file = std::filesystem::absolute(curve.page) / "graph.json";
        writeFile(graph.file, saveGraph(graph));
        sweep = sweepOfGraph(graph, registry, scene, parseSize(arguments.size),
                             curve.frames > 0 ? curve.frames : 16);
        sweep.file = file;
    }
    sweep.allowOutside = arguments.sceneOptions.allowOutside;
    return sweep;
}

} // namespace

int drawCurve(const GraphArguments& arguments, const CurveArguments& curve) {
    const StressCurve& which = stressCurve(curve.curve);
    if (curve.page.empty())
        throw InputError("--curve needs --page: the folder for the plot, its figures and the pictures");
    if (std::ranges::any_of(curve.values, [](double value) { return !(value > 0); }))
        throw InputError("--values: each must be above 0");
    requireWritableFolder(curve.page);
    if (!curve.json.empty()) requireWritable(curve.json);
    const Registry& registry = loadedRegistry();
    const Sweep sweep = sweepOf(arguments, curve, registry);
    const std::vector<SweepPoint> points = expandSweep(sweep);
    checkSweep(sweep, points, registry);
    checkSweepScenes(sweep);
    const std::filesystem::path page = curve.page;
    const auto write = [&](const CurveResults& results) {
        const std::string json = curveJson(results);
        writeFile(page / "curve.json", json);
        if (!curve.json.empty()) writeFile(curve.json, json);
        std::set<std::string> slugs;
        for (const CurvePlot& plot : results.plots)
            writeFile(page / fmt::format("{}-{}.svg", results.curve, sweepSlug(plot.scene, slugs)),
                      curveSvg(results, plot));
        writeFile(page / "index.html", curvePage(results));
    };
    ProgressBar progress("curve");
    CurveOptions options{.folder = page / "pictures",
                         .worker = curve.worker,
                         .values = curve.values,
                         .chosen = choosePoints(points, curve.only),
                         .timeout = curve.timeout};
    options.progress = [&](double share, const std::string& what) { progress.update(share, what); };
    options.finished = write; // at once: a run that is stopped leaves what it has
    const CurveResults results = runCurve(which, sweep, registry, options);
    progress.clear();
    say("{}{}\n", curveText(results), (page / "index.html").string());
    return static_cast<int>(ExitStatus::Done);
}

} // namespace kestrel
