#include "measure/stress/curve_run.h"
#include "core/files.h"
#include "image/io.h"
#include "measure/stress/stress_distance.h"
#include "measure/stress/stress_workers.h"
#include "measure/sweep_results.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kestrel {
namespace {

namespace fs = std::filesystem;

// What does not count is 0 in both.
void apply(const Image& mask, Image& image) {
    if (mask.width != image.width || mask.height != image.height) return;
    for (size_t i = 0; i < image.pixelCount(); ++i)
        if (!(mask.values[i * static_cast<size_t>(mask.channels)] > 0.5f))
            std::fill_n(image.values.begin() + static_cast<std::ptrdiff_t>(i) * image.channels,
                        image.channels, 0.0f);
}

// One graph on one scene in a process of its own.
class Technique {
public:
    Technique(const fs::path& folder, Graph graph, const Sweep& sweep, const SweepScene& scene, int frames,
              const CurveOptions& options)
        : folder_(folder)
        , workers_(commandOf(folder, std::move(graph), sweep, scene, frames, options), options.timeout) {}

    // The picture of a port, or none, with the reason.
    std::optional<Image> picture(const std::string& name, const PortRef& port, std::string& why) {
        const std::optional<StressCase> one = curveCase(name);
        if (!told_.contains(name)) told_.emplace(name, workers_.run(*one));
        const StressResult& result = told_.at(name);
        why = result.why;
        if (!result.where.empty() && !why.empty()) why += ", in " + result.where;
        for (const StressCheck& check : result.checks)
            if (!check.held && why.empty()) why = check.what;
        const fs::path file = folder_ / keptPictureName(name, port.text());
        std::error_code ignored;
        if (!fs::exists(file, ignored)) {
            if (why.empty()) why = fmt::format("there is no picture of '{}'", port.text());
            return {};
        }
        return readImage(file);
    }
    const std::string& renderer() { return workers_.renderer(); }

private:
    static std::vector<std::string> commandOf(const fs::path& folder, Graph graph, const Sweep& sweep,
                                              const SweepScene& scene, int frames,
                                              const CurveOptions& options) {
        const fs::path here = sweep.file.has_parent_path() ? sweep.file.parent_path() : ".";
        graph.sceneSetup = joined(located(std::move(graph.sceneSetup), graph.file.parent_path()),
                                  located(scene.setup, here));
        const fs::path file = folder / "graph.json";
        std::error_code ignored;
        fs::remove_all(folder, ignored); // pictures of another run
        writeFile(file, saveGraph(graph));
        std::vector<std::string> command = options.worker;
        const bool builtin = scene.source.starts_with("builtin:");
        const std::string source = builtin ? scene.source : sweepSceneFile(sweep, scene).string();
        command.insert(command.end(), {file.string(), "--scene", source, "--size",
                                       fmt::format("{}x{}", sweep.size.width, sweep.size.height), "--frames",
                                       std::to_string(frames), "--keep", folder.string(), "--worker"});
        if (sweep.allowOutside) command.emplace_back("--allow-outside");
        return command;
    }

    fs::path folder_;
    StressWorkers workers_;
    std::map<std::string, StressResult> told_;
};

class CurveRunner {
public:
    CurveRunner(const StressCurve& curve, const Sweep& sweep, const Registry& registry,
                const CurveOptions& options)
        : curve_(curve)
        , sweep_(sweep)
        , registry_(registry)
        , options_(options)
        , values_(options.values.empty() ? curve.values : options.values) {}

    CurveResults run() {
        const std::vector<SweepPoint> points = expandSweep(sweep_);
        CurveResults results{.curve = std::string(curve_.name),
                             .title = sweep_.title,
                             .file = sweep_.file.string(),
                             .size = fmt::format("{}x{}", sweep_.size.width, sweep_.size.height),
                             .frames = sweep_.frames};
        const auto chosen = [&](size_t i) {
            return !points[i].ray && (options_.chosen.empty() || options_.chosen[i]);
        };
        size_t count = 0, done = 0;
        for (size_t i = 0; i < points.size(); ++i) count += chosen(i) ? 1 : 0;
        count *= sweep_.scenes.size();
        std::set<std::string> slugs;
        for (const SweepScene& scene : sweep_.scenes) {
            const fs::path folder = options_.folder / sweepSlug(scene.name, slugs);
            takeReference(folder, scene);
            results.plots.push_back({.scene = scene.name, .hasTruth = reference_ != nullptr});
            for (size_t i = 0; i < points.size(); ++i) {
                if (!chosen(i)) continue;
                if (options_.progress)
                    options_.progress(static_cast<double>(done++) / static_cast<double>(count),
                                      scene.name + ": " + points[i].name);
                results.plots.back().series.push_back(seriesOf(folder, scene, points[i], results));
                if (options_.finished) options_.finished(results);
            }
        }
        return results;
    }

private:
    void takeReference(const fs::path& folder, const SweepScene& scene) {
        reference_.reset();
        mask_ = {};
        if (!sweep_.reference) return;
        const SweepReference& of = *sweep_.reference;
        std::vector<PortRef> outputs{of.output};
        if (of.mask) outputs.push_back(*of.mask);
        reference_ = std::make_unique<Technique>(
            folder / "reference", sweepGraph(sweep_, of.graph, of.settings, outputs, registry_, of.where),
            sweep_, scene, of.frames, options_);
    }

    // The truth at a value, and what of it counts.
    std::optional<Image> truth(double value) {
        if (!reference_) return {};
        const SweepReference& of = *sweep_.reference;
        const std::string name =
            curveCaseName(curve_, curve_.staysSame ? CurvePicture::Plain : CurvePicture::At, value);
        std::string why;
        mask_ = {};
        if (of.mask)
            if (std::optional<Image> mask = reference_->picture(name, *of.mask, why))
                mask_ = std::move(*mask);
        return reference_->picture(name, of.output, why);
    }

    [[nodiscard]] double distance(const std::optional<Image>& to, const std::optional<Image>& of) const {
        if (!to || !of) return std::numeric_limits<double>::infinity();
        Image a = *to, b = *of;
        if (!mask_.values.empty()) {
            apply(mask_, a);
            apply(mask_, b);
        }
        return stressDistance(a, b).rms;
    }

    CurveSeries seriesOf(const fs::path& folder, const SweepScene& scene, const SweepPoint& point,
                         CurveResults& results) {
        CurveSeries series{.name = point.name};
        std::vector<std::string> words{"kestrel",
                                       "stress",
                                       sweep_.file.string(),
                                       "--curve",
                                       std::string(curve_.name),
                                       "--only",
                                       point.name,
                                       "--page",
                                       "page"};
        for (std::string& word : words) word = shellWord(word);
        series.command = fmt::format("{}", fmt::join(words, " "));
        Technique technique(
            folder / point.slug,
            sweepGraph(sweep_, point.graph, point.settings, {point.output}, registry_, point.where), sweep_,
            scene, point.frames, options_);
        results.renderer = technique.renderer();
        const auto picture = [&](CurvePicture which, double value, std::string& why) {
            return technique.picture(curveCaseName(curve_, which, value), point.output, why);
        };
        std::optional<Image> plain;
        if (curve_.staysSame) {
            const std::optional<Image> known = truth(0);
            plain = picture(CurvePicture::Plain, 0, series.plain.why);
            std::string ignored;
            series.plain.own = distance(plain, picture(CurvePicture::Seed, 0, ignored));
            if (reference_) series.plain.truth = distance(known, plain);
        }
        for (const double value : values_) {
            CurvePoint found{.value = value};
            const std::optional<Image> known = truth(value),
                                       seen = picture(CurvePicture::At, value, found.why);
            std::string ignored;
            const std::optional<Image> other =
                curve_.staysSame ? plain : picture(CurvePicture::Reversed, value, ignored);
            found.own = distance(other, seen);
            if (reference_) found.truth = distance(known, seen);
            series.points.push_back(std::move(found));
        }
        return series;
    }

    const StressCurve& curve_;
    const Sweep& sweep_;
    const Registry& registry_;
    const CurveOptions& options_;
    std::vector<double> values_;
    std::unique_ptr<Technique> reference_;
    Image mask_;
};

} // namespace

Sweep sweepOfGraph(const Graph& graph, const Registry& registry, const std::string& scene, const Extent& size,
                   int frames) {
    Sweep sweep;
    sweep.name = graph.file.stem().string();
    sweep.title = graph.name;
    sweep.file = graph.file;
    sweep.size = size;
    sweep.frames = frames;
    SweepScene& only = sweep.scenes.emplace_back();
    only.name = only.source = scene;
    for (const GraphOutput& output : graph.outputs) {
        const GraphPass* pass = graph.find(output.port.pass);
        const PassType* type = pass != nullptr ? registry.find(pass->type) : nullptr;
        const PortInfo* port = type != nullptr ? type->port(output.port.port) : nullptr;
        if (port == nullptr || port->kind != PortKind::Texture) continue;
        SweepVariant& variant = sweep.variants.emplace_back();
        variant.name = output.port.text();
        variant.graph = fs::absolute(graph.file).string();
        variant.output = output.port;
        variant.where = output.where;
    }
    return sweep;
}

CurveResults runCurve(const StressCurve& curve, const Sweep& sweep, const Registry& registry,
                      const CurveOptions& options) {
    return CurveRunner(curve, sweep, registry, options).run();
}

} // namespace kestrel
