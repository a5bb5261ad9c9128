// Rows of a sweep: times over all repetitions, and the Pareto front.
#include "measure/sweep_results.h"
#include <algorithm>
#include <cmath>
#include <set>

namespace kestrel {
namespace {

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

} // namespace kestrel
