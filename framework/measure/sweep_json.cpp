// results.json.
#include "core/version.h"
#include "measure/sweep_results.h"
#include <algorithm>
#include <nlohmann/json.hpp>

namespace kestrel {
namespace {

using RowJson = nlohmann::ordered_json;

RowJson optionalNumber(const std::optional<double>& value) {
    return value ? RowJson(*value) : RowJson(nullptr);
}

RowJson timesJson(const SweepRow& row, double Quartiles::*which) {
    RowJson json = RowJson::object();
    for (const auto& [name, quartiles] : row.ms) json[name] = quartiles.*which;
    return json;
}

RowJson rowJson(const SweepRow& row) {
    const SweepPicture& picture = row.picture;
    RowJson axes = RowJson::object(), steps = RowJson::array(), leftOut = RowJson::array();
    for (const auto& [name, label] : row.axes) axes[name] = label;
    for (const auto& [name, quartiles] : row.steps)
        steps.push_back(
            {{"step", name}, {"ms", quartiles.median}, {"q1", quartiles.q1}, {"q3", quartiles.q3}});
    for (const LeftOut& item : picture.leftOut) leftOut.push_back({{"what", item.what}, {"why", item.why}});
    const auto error = [&](double SweepErrors::*which) {
        return picture.errors ? RowJson((*picture.errors).*which) : RowJson(nullptr);
    };
    RowJson json = {
        {"scene", row.scene},
        {"camera", row.camera},
        {"variant", row.point},
        {"kind", row.ray ? "rays" : "picture"},
        {"of", row.variant},
        {"series", row.series},
        {"along", row.along},
        {"plot", row.plot},
        {"axes", axes},
        {"machine", row.machine},
        {"failed", picture.failed.empty() ? RowJson(nullptr) : RowJson(picture.failed)},
        {"repeat_count", row.repeats},
        {"ms", timesJson(row, &Quartiles::median)},
        {"ms_q1", timesJson(row, &Quartiles::q1)},
        {"ms_q3", timesJson(row, &Quartiles::q3)},
        {"steps", steps},
        {"memory", picture.transient + picture.persistent},
        {"memory_transient", picture.transient},
        {"memory_unshared", picture.unshared},
        {"memory_persistent", picture.persistent},
        {"compile_ms", picture.compileMs},
        {"set_up_ms", picture.setUpMs},
        {"left_out_count", picture.leftOut.size()},
        {"left_out", leftOut},
        {"mse", error(&SweepErrors::mse)},
        {"psnr", picture.errors ? optionalNumber(picture.errors->psnr) : RowJson(nullptr)},
        {"ssim", error(&SweepErrors::ssim)},
        {"flip", error(&SweepErrors::flip)},
        {"reference_noise", optionalNumber(row.referenceNoise)},
        {"reports", picture.reports},
        {"pareto", row.pareto},
        {"picture", picture.picture},
        {"heat_map", picture.heatMap},
        {"command", row.command},
        {"times_command", row.timesCommand},
    };
    if (picture.split)
        json["split"] = {{"mse", picture.split->mse},
                         {"representation", picture.split->representation},
                         {"algorithm", picture.split->algorithm},
                         {"cross", picture.split->cross},
                         {"sampling", picture.split->sampling},
                         {"reference_noise", picture.split->referenceNoise},
                         {"sum", picture.split->sum()}};
    if (!row.tunedOf.empty()) json["tuned_of"] = row.tunedOf;
    if (picture.rays) {
        const SweepRayFigures& rays = *picture.rays;
        const auto tracing = row.ms.find("tracing");
        json["rays"] = {{"count", rays.rays},
                        {"hit_share", rays.hitShare},
                        {"agreement", rays.agreement},
                        {"distance_error", optionalNumber(rays.distanceError)},
                        {"tracing_ns", tracing == row.ms.end() || rays.rays == 0
                                           ? RowJson(nullptr)
                                           : RowJson(tracing->second.median * 1e6 / rays.rays)}};
    }
    return json;
}

RowJson machinesJson(const SweepResults& results) {
    RowJson machines = RowJson::array();
    for (const SweepMachine& machine : results.machines) {
        RowJson json = {{"id", machine.id},           {"cpu", machine.cpu},
                        {"threads", machine.threads}, {"renderer", machine.renderer},
                        {"driver", machine.driver},   {"clock", machine.clock},
                        {"version", machine.version}, {"date", machine.date}};
        std::vector<double> one, two;
        if (const auto spins = results.spins.find(machine.id); spins != results.spins.end())
            for (const auto& [first, second] : spins->second) {
                one.push_back(first);
                two.push_back(second);
            }
        const auto spin = [](const std::vector<double>& series) {
            const Quartiles quartiles = quartilesOf(series);
            return RowJson{{"median", quartiles.median},
                           {"min", series.empty() ? 0 : std::ranges::min(series)},
                           {"max", series.empty() ? 0 : std::ranges::max(series)}};
        };
        json["spin"] = {{"one_thread_ms", spin(one)}, {"two_threads_ms", spin(two)}};
        machines.push_back(std::move(json));
    }
    return machines;
}

// What `kestrel tune` found.
RowJson tuneJson(const Sweep& sweep, const TuneReport& report) {
    const SweepTuning& tuning = *sweep.tuning;
    RowJson points = RowJson::array(), ranks = RowJson::array();
    for (const TuneReport::Point& point : report.points) {
        const TuneOutcome& outcome = point.outcome;
        RowJson path = RowJson::array();
        for (const TuneOutcome::Step& step : outcome.path)
            path.push_back(
                {{"round", step.round}, {"along", step.along}, {"set", step.set}, {"error", step.error}});
        points.push_back({{"variant", point.name},
                          {"start", outcome.start},
                          {"set", outcome.set},
                          {"start_error", outcome.startError},
                          {"error", outcome.error},
                          {"held_out_start_error", optionalNumber(point.heldOutDefault)},
                          {"held_out_error", optionalNumber(point.heldOutTuned)},
                          {"time_ratio", outcome.timeRatio},
                          {"asked", outcome.asked},
                          {"too_slow", outcome.tooSlow},
                          {"path", path}});
    }
    for (const TuneReport::Ranks& plot : report.ranks)
        ranks.push_back({{"scene", plot.scene},
                         {"plot", plot.plot},
                         {"trained", plot.trained},
                         {"held_out", plot.heldOut},
                         {"default", plot.byDefault},
                         {"tuned", plot.byTuned},
                         {"changed", plot.changed()}});
    return {{"train", tuning.train},
            {"hold_out", tuning.holdOut},
            {"steps", tuning.steps},
            {"rounds", tuning.rounds},
            {"probes", tuning.probes},
            {"most_time", tuning.mostMs ? RowJson(nullptr) : RowJson(tuning.mostTime)},
            {"most_ms", optionalNumber(tuning.mostMs)},
            {"points", points},
            {"ranks", ranks},
            {"defaults_within_5_percent", report.within(0.05)},
            {"held_out_plots", report.heldOut()},
            {"held_out_plots_changed", report.heldOutChanged()}};
}

RowJson documentJson(const Sweep& sweep, const SweepResults& results) {
    RowJson scenes = RowJson::array(), rows = RowJson::array(), times = RowJson::array();
    for (const SweepScene& scene : sweep.scenes) {
        RowJson json = {{"name", scene.name}, {"source", scene.source}, {"camera", cameraOf(scene)}};
        if (const auto record = results.references.find(scene.name); record != results.references.end()) {
            json["reference"] = record->second.picture;
            json["reference_noise"] = optionalNumber(record->second.noise);
            json["reference_reports"] = record->second.reports;
            if (record->second.rays > 0) json["reference_hit_share"] = record->second.hitShare;
            if (record->second.nothingCounts) json["nothing_counts"] = true;
        }
        scenes.push_back(std::move(json));
    }
    for (const SweepRow& row : results.rows) rows.push_back(rowJson(row));
    for (const SweepTime& time : sweep.times) times.push_back(time.name);
    RowJson document = {{"kestrel_sweep_results", 1},
                        {"name", sweep.name},
                        {"title", sweep.title},
                        {"comment", sweep.comment},
                        {"file", sweep.file.filename().string()},
                        {"command", sweepCommand(sweep)},
                        {"hash", results.hash},
                        {"version", version()},
                        {"configuration", configuration()},
                        {"size", {sweep.size.width, sweep.size.height}},
                        {"frames", sweep.frames},
                        {"seed", sweep.seed},
                        {"warm_up", sweep.warmUp},
                        {"repeats", sweep.repeats},
                        {"timed_frames", sweep.timedFrames},
                        {"moving", sweep.moving},
                        {"rebuild", sweep.rebuild},
                        {"hdr", sweep.hdr},
                        {"plot", {{"time", sweep.plotTime}, {"error", sweep.plotError}}},
                        {"times", times},
                        {"machines", machinesJson(results)},
                        {"scenes", scenes},
                        {"rows", rows},
                        {"missing", results.missing}};
    if (results.tuning) document["tuning"] = tuneJson(sweep, *results.tuning);
    return document;
}

} // namespace

std::string resultsJson(const Sweep& sweep, const SweepResults& results) {
    return documentJson(sweep, results).dump(1, ' ', false, RowJson::error_handler_t::replace) + "\n";
}

} // namespace kestrel
