#include "measure/tune/tune_space.h"
#include "graph/value_text.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

namespace kestrel {
namespace {

// A value as --set takes it.
std::string settingText(const Value& value) {
    if (const auto* text = std::get_if<std::string>(&value)) return *text;
    if (const auto* number = std::get_if<double>(&value)) return numberText(*number);
    return jsonText(value);
}

// Reads one free property against the graph; notes what is wrong with it.
class FreeReader {
public:
    FreeReader(const Graph& graph, const Registry& registry, std::vector<Problem>& problems)
        : graph_(graph)
        , registry_(registry)
        , problems_(problems) {}

    void read(const SweepFree& free, TuneSpace& space) {
        const size_t before = problems_.size();
        if (free.choices.empty()) {
            for (const double end : {free.low, free.high}) tryValue(free, numberText(end), free.where);
        } else {
            for (const SweepSetting& choice : free.choices) tryValue(free, choice.text, choice.where);
        }
        const PropertyInfo* property = propertyOf(free);
        const bool number = property != nullptr &&
                            (property->kind == PropertyKind::Int || property->kind == PropertyKind::Float);
        if (problems_.size() == before && free.choices.empty() && !number)
            problems_.push_back({free.where, fmt::format("'{}' is no number: name its choices", free.name)});
        if (problems_.size() > before) return;
        space.names.push_back(free.name);
        space.choices.emplace_back();
        if (free.choices.empty()) {
            space.axes.push_back(
                {free.low, free.high, property->kind == PropertyKind::Int, free.logarithmic});
            space.start.push_back(std::stod(startText(free, property)));
            return;
        }
        std::vector<std::string>& choices = space.choices.back();
        for (const SweepSetting& choice : free.choices) choices.push_back(choice.text);
        const std::string start = startText(free, property);
        auto at = std::ranges::find(choices, start);
        if (at == choices.end()) at = choices.insert(choices.begin(), start);
        space.start.push_back(static_cast<double>(at - choices.begin()));
        space.axes.push_back({.choices = static_cast<int>(choices.size())});
    }

private:
    void tryValue(const SweepFree& free, const std::string& text, const Location& where) {
        try {
            Graph changed = graph_;
            applySetting(changed, registry_, free.name + "=" + text);
        } catch (const InputError& error) {
            for (const Problem& problem : error.problems()) {
                // Both ends of a range share what is wrong with the name.
                const bool told = std::ranges::any_of(problems_, [&](const Problem& other) {
                    return other.message == problem.message && other.where.line == where.line &&
                           other.where.column == where.column;
                });
                if (!told) problems_.push_back({where, problem.message});
            }
        }
    }

    [[nodiscard]] const PropertyInfo* propertyOf(const SweepFree& free) const {
        const auto ref = parsePortRef(free.name);
        const GraphPass* pass = ref ? graph_.find(ref->pass) : nullptr;
        const PassType* type = pass != nullptr ? registry_.find(pass->type) : nullptr;
        return type != nullptr ? type->property(ref->port) : nullptr;
    }

    // Of a property, or the output that feeds an input.
    [[nodiscard]] std::string startText(const SweepFree& free, const PropertyInfo* property) const {
        const PortRef ref = *parsePortRef(free.name);
        if (property == nullptr) {
            for (const GraphEdge& edge : graph_.edges)
                if (edge.to == ref) return edge.from.text();
            return "";
        }
        for (const auto& [name, value] : graph_.find(ref.pass)->properties)
            if (name == ref.port) return settingText(value);
        return settingText(property->defaultValue);
    }

    const Graph& graph_;
    const Registry& registry_;
    std::vector<Problem>& problems_;
};

Graph graphOf(const Sweep& sweep, const SweepPoint& point, const Registry& registry) {
    return sweepGraph(sweep, point.graph, point.settings, {point.output}, registry, point.where);
}

} // namespace

std::vector<std::string> TuneSpace::settings(const TuneSetting& setting) const {
    std::vector<std::string> texts;
    for (size_t i = 0; i < axes.size(); ++i)
        texts.push_back(
            names[i] + "=" +
            (choices[i].empty() ? numberText(setting[i]) : choices[i][static_cast<size_t>(setting[i])]));
    return texts;
}

TuneSpace tuneSpace(const Sweep& sweep, const SweepPoint& point, const Registry& registry) {
    const Graph graph = graphOf(sweep, point, registry);
    std::vector<Problem> problems;
    TuneSpace space;
    FreeReader reader(graph, registry, problems);
    for (const SweepFree& free : point.free) reader.read(free, space);
    if (!problems.empty()) throw InputError(std::move(problems));
    return space;
}

void checkTuning(const Sweep& sweep, const std::vector<SweepPoint>& points, const Registry& registry) {
    const Location file{sweep.file.string()};
    if (!sweep.tuning)
        throw InputError(file, "has no 'tune': which scenes it is tuned on ({\"train\": [...]})");
    std::vector<Problem> problems;
    std::set<std::string> told;
    for (const SweepPoint& point : points) try {
            static_cast<void>(tuneSpace(sweep, point, registry));
        } catch (const InputError& error) {
            for (const Problem& problem : error.problems())
                if (told.insert(problem.text()).second) problems.push_back(problem);
        }
    std::set<std::string> names;
    for (const SweepPoint& point : points) names.insert(point.name);
    for (const SweepPoint& point : points)
        if (!point.free.empty() && names.contains(point.name + ", tuned"))
            problems.push_back(
                {point.where,
                 fmt::format("'{0}, tuned' is what '{0}' will be: rename one of them", point.name)});
    if (std::ranges::all_of(points, [](const SweepPoint& point) { return point.free.empty(); }))
        problems.push_back({file, "no variant has a 'tune': nothing is free"});
    if (!problems.empty()) throw InputError(std::move(problems));
}

SweepPoint withSettings(SweepPoint point, const std::vector<std::string>& settings) {
    for (const std::string& setting : settings) point.settings.push_back({setting, point.where});
    return point;
}

} // namespace kestrel
