// Rows of a sweep: times over all repetitions, the Pareto front, results.json and results.csv.
#include "measure/sweep_results.h"
#include "core/version.h"
#include "graph/value_text.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <set>

namespace kestrel {
namespace {

using RowJson = nlohmann::ordered_json;

double sortedAt(const std::vector<double>& sorted, double fraction) {
    const double at = fraction * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<size_t>(at);
    const size_t above = std::min(below + 1, sorted.size() - 1);
    return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

// The machine that most repetitions are of.
std::string mainMachine(const std::vector<SweepRepetition>& repetitions) {
    std::map<std::string, size_t> counts;
    for (const SweepRepetition& repetition : repetitions)
        counts[repetition.machine] += repetition.frames.size();
    const auto most = std::ranges::max_element(counts, {}, [](const auto& count) { return count.second; });
    return most == counts.end() ? std::string() : most->first;
}

// The times of one frame by what they count as.
std::map<std::string, double> frameTimes(const SweepFrame& frame, const Sweep& sweep) {
    std::map<std::string, double> groups, passes;
    double total = 0;
    for (const SweepFrame::Step& step : frame.steps) {
        groups[step.group] += step.ms;
        passes[step.pass] += step.ms;
        total += step.ms;
    }
    std::map<std::string, double> times = groups;
    for (const SweepTime& time : sweep.times) {
        double sum = 0;
        for (const SweepTime::Term& term : time.terms) {
            const auto group = groups.find(term.name);
            const auto pass = passes.find(term.name);
            sum += term.factor * (group != groups.end()  ? group->second
                                  : pass != passes.end() ? pass->second
                                                         : 0);
        }
        times[time.name] = sum;
    }
    times["total"] = total;
    times["frame"] = frame.ms;
    return times;
}

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
                        {"version", machine.version}};
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

RowJson documentJson(const Sweep& sweep, const SweepResults& results) {
    RowJson scenes = RowJson::array(), rows = RowJson::array(), times = RowJson::array();
    for (const SweepScene& scene : sweep.scenes) {
        RowJson json = {{"name", scene.name}, {"source", scene.source}, {"camera", scene.camera}};
        if (const auto record = results.references.find(scene.name); record != results.references.end()) {
            json["reference"] = record->second.picture;
            json["reference_noise"] = optionalNumber(record->second.noise);
            json["reference_reports"] = record->second.reports;
            if (record->second.rays > 0) json["reference_hit_share"] = record->second.hitShare;
        }
        scenes.push_back(std::move(json));
    }
    for (const SweepRow& row : results.rows) rows.push_back(rowJson(row));
    for (const SweepTime& time : sweep.times) times.push_back(time.name);
    return {{"kestrel_sweep_results", 1},
            {"name", sweep.name},
            {"title", sweep.title},
            {"comment", sweep.comment},
            {"file", sweep.file.filename().string()},
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
}

std::string csvField(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

std::string csvNumber(const std::optional<double>& value) {
    return value ? numberText(*value) : std::string();
}

// The names that columns are made of, over all rows.
struct CsvColumns {
    std::set<std::string> times, axes, reports;
};

CsvColumns csvColumns(const SweepResults& results) {
    CsvColumns columns;
    for (const SweepRow& row : results.rows) {
        for (const auto& [name, label] : row.axes) columns.axes.insert(name);
        for (const auto& [name, time] : row.ms) columns.times.insert(name);
        for (const auto& [name, value] : row.picture.reports) columns.reports.insert(name);
    }
    return columns;
}

std::vector<std::string> csvHeader(const CsvColumns& columns) {
    std::vector<std::string> header{"scene", "camera", "variant", "kind", "series", "plot"};
    for (const std::string& axis : columns.axes) header.push_back("axis " + axis);
    header.insert(header.end(), {"machine", "repeat_count"});
    for (const std::string& time : columns.times)
        for (const char* which : {"", " q1", " q3"}) header.push_back("ms " + time + which);
    header.insert(header.end(), {"memory_transient", "memory_persistent", "compile_ms", "set_up_ms",
                                 "left_out_count", "mse", "psnr", "ssim", "flip", "reference_noise", "rays",
                                 "hit_share", "agreement", "distance_error"});
    for (const std::string& report : columns.reports) header.push_back("report " + report);
    header.insert(header.end(), {"pareto", "failed", "command"});
    return header;
}

std::vector<std::string> csvFields(const SweepRow& row, const CsvColumns& columns) {
    const SweepPicture& picture = row.picture;
    std::vector<std::string> fields{row.scene,  row.camera, row.point, row.ray ? "rays" : "picture",
                                    row.series, row.plot};
    for (const std::string& axis : columns.axes) {
        const auto found = std::ranges::find(row.axes, axis, &std::pair<std::string, std::string>::first);
        fields.push_back(found == row.axes.end() ? "" : found->second);
    }
    fields.insert(fields.end(), {row.machine, std::to_string(row.repeats)});
    for (const std::string& time : columns.times) {
        const auto found = row.ms.find(time);
        const bool known = found != row.ms.end();
        for (double Quartiles::*which : {&Quartiles::median, &Quartiles::q1, &Quartiles::q3})
            fields.push_back(known ? numberText(found->second.*which) : "");
    }
    const auto error = [&](double SweepErrors::*which) {
        return picture.errors ? numberText((*picture.errors).*which) : std::string();
    };
    const auto ray = [&](double SweepRayFigures::*which) {
        return picture.rays ? numberText((*picture.rays).*which) : std::string();
    };
    fields.insert(fields.end(),
                  {std::to_string(picture.transient), std::to_string(picture.persistent),
                   numberText(picture.compileMs), numberText(picture.setUpMs),
                   std::to_string(picture.leftOut.size()), error(&SweepErrors::mse),
                   csvNumber(picture.errors ? picture.errors->psnr : std::nullopt), error(&SweepErrors::ssim),
                   error(&SweepErrors::flip), csvNumber(row.referenceNoise), ray(&SweepRayFigures::rays),
                   ray(&SweepRayFigures::hitShare), ray(&SweepRayFigures::agreement),
                   csvNumber(picture.rays ? picture.rays->distanceError : std::nullopt)});
    for (const std::string& report : columns.reports) {
        const auto found = picture.reports.find(report);
        fields.push_back(found == picture.reports.end() ? "" : numberText(found->second));
    }
    fields.insert(fields.end(), {row.pareto ? "yes" : "no", picture.failed, row.command});
    return fields;
}

std::string csvLine(const std::vector<std::string>& fields) {
    std::string line;
    for (const std::string& field : fields) line += (line.empty() ? "" : ",") + csvField(field);
    return line + "\r\n";
}

} // namespace

Quartiles quartilesOf(std::vector<double> series) {
    if (series.empty()) return {};
    std::ranges::sort(series);
    return {sortedAt(series, 0.25), sortedAt(series, 0.5), sortedAt(series, 0.75)};
}

void addTimes(SweepRow& row, const Sweep& sweep, const std::vector<SweepRepetition>& repetitions) {
    row.machine = mainMachine(repetitions);
    std::vector<std::map<std::string, double>> frames;
    std::map<std::string, std::vector<double>> bySteps;
    std::vector<std::string> order;
    for (const SweepRepetition& repetition : repetitions) {
        if (repetition.machine != row.machine) continue;
        for (const SweepFrame& frame : repetition.frames) {
            frames.push_back(frameTimes(frame, sweep));
            std::map<std::string, double> ofFrame;
            for (const SweepFrame::Step& step : frame.steps) {
                const std::string name = step.pass + "." + step.step;
                if (!bySteps.contains(name)) order.push_back(name);
                bySteps[name];
                ofFrame[name] += step.ms;
            }
            for (const auto& [name, ms] : ofFrame) bySteps[name].push_back(ms);
        }
    }
    row.repeats = static_cast<int>(frames.size());
    // What did not run in a frame took no time in it.
    std::set<std::string> names;
    for (const auto& times : frames)
        for (const auto& [name, ms] : times) names.insert(name);
    for (const std::string& name : names) {
        std::vector<double> series;
        for (const auto& times : frames) series.push_back(times.contains(name) ? times.at(name) : 0);
        row.ms[name] = quartilesOf(std::move(series));
    }
    for (const std::string& name : order) {
        std::vector<double>& series = bySteps[name];
        series.resize(frames.size(), 0.0);
        row.steps.emplace_back(name, quartilesOf(series));
    }
}

std::vector<size_t> paretoFront(const std::vector<std::pair<double, double>>& timeAndError) {
    std::vector<size_t> order;
    for (size_t i = 0; i < timeAndError.size(); ++i)
        if (std::isfinite(timeAndError[i].first) && std::isfinite(timeAndError[i].second)) order.push_back(i);
    std::ranges::stable_sort(order, {}, [&](size_t i) { return timeAndError[i]; });
    std::vector<size_t> front;
    for (const size_t i : order) {
        // Equals stand side by side: none beats the other.
        const bool better = front.empty() || timeAndError[i].second < timeAndError[front.back()].second;
        if (better || timeAndError[i] == timeAndError[front.back()]) front.push_back(i);
    }
    return front;
}

std::optional<double> errorOf(const SweepRow& row, const std::string& error) {
    if (row.ray) return row.picture.rays ? std::optional(1 - row.picture.rays->agreement) : std::nullopt;
    if (!row.picture.errors) return std::nullopt;
    const SweepErrors& errors = *row.picture.errors;
    if (error == "mse") return errors.mse;
    if (error == "rmse") return std::sqrt(errors.mse);
    if (error == "ssim") return 1 - errors.ssim;
    return errors.flip;
}

void markPareto(std::vector<SweepRow>& rows, const Sweep& sweep) {
    std::map<std::vector<std::string>, std::vector<size_t>> plots;
    for (size_t i = 0; i < rows.size(); ++i) {
        rows[i].pareto = false;
        const SweepRow& row = rows[i];
        if (row.ms.contains(sweep.plotTime) && errorOf(row, sweep.plotError))
            plots[{row.scene, row.plot, row.machine, row.ray ? "rays" : "picture"}].push_back(i);
    }
    for (const auto& [plot, members] : plots) {
        std::vector<std::pair<double, double>> points;
        for (const size_t i : members)
            points.emplace_back(rows[i].ms.at(sweep.plotTime).median, *errorOf(rows[i], sweep.plotError));
        for (const size_t k : paretoFront(points)) rows[members[k]].pareto = true;
    }
}

std::string resultsJson(const Sweep& sweep, const SweepResults& results) {
    return documentJson(sweep, results).dump(1, ' ', false, RowJson::error_handler_t::replace) + "\n";
}

std::string resultsCsv(const Sweep&, const SweepResults& results) {
    const CsvColumns columns = csvColumns(results);
    std::string text = csvLine(csvHeader(columns));
    for (const SweepRow& row : results.rows) text += csvLine(csvFields(row, columns));
    return text;
}

std::string shellWord(const std::string& word) {
    const bool plain =
        !word.empty() && word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                "0123456789_-+=./:,@%") == std::string::npos;
    if (plain) return word;
    std::string quoted;
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return "'" + quoted + "'";
}

std::string renderCommand(const Sweep& sweep, const SweepScene& scene, const SweepPoint& point) {
    const auto near = [](const std::filesystem::path& file) { // as it is named from here, if it is below
        std::error_code ignored;
        const auto relative =
            std::filesystem::relative(file, std::filesystem::current_path(ignored), ignored);
        return !relative.empty() && relative.begin()->string() != ".." ? relative.string() : file.string();
    };
    std::vector<std::string> words{"kestrel", "render", near(sweepGraphFile(sweep, point.graph)), "--scene"};
    const bool builtin = scene.source.starts_with("builtin:");
    words.push_back(builtin ? scene.source : near(sweep.file.parent_path() / scene.source));
    if (!scene.camera.empty()) words.insert(words.end(), {"--camera", scene.camera});
    words.insert(words.end(), {"--size", fmt::format("{}x{}", sweep.size.width, sweep.size.height),
                               "--frames", std::to_string(point.frames)});
    if (sweep.seed != 0) words.insert(words.end(), {"--seed", std::to_string(sweep.seed)});
    if (!sweep.moving) words.push_back("--still");
    for (const SweepSetting& setting : point.settings) words.insert(words.end(), {"--set", setting.text});
    words.insert(words.end(), {"--output", fmt::format("{}={}.{}", point.output.text(), point.slug,
                                                       point.ray ? "bin" : "exr")});
    std::string command;
    for (const std::string& word : words) command += (command.empty() ? "" : " ") + shellWord(word);
    return command;
}

} // namespace kestrel
