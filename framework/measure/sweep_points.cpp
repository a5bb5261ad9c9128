// What a sweep file unfolds to: points, units, shards; and whether the graphs bear it.
#include "core/files.h"
#include "measure/sweep_file.h"
#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <set>

namespace kestrel {
namespace {

using Choice = std::vector<const SweepAxisValue*>; // one of each axis

bool excluded(const SweepVariant& variant, const Choice& choice) {
    return std::ranges::any_of(variant.exclude, [&](const auto& exclusion) {
        for (size_t i = 0; i < variant.axes.size(); ++i) {
            const auto label = exclusion.find(variant.axes[i].name);
            if (label != exclusion.end() && label->second != choice[i]->label) return false;
        }
        return true;
    });
}

std::string withLabels(std::string text, const SweepVariant& variant, const Choice& choice) {
    for (size_t i = 0; i < variant.axes.size(); ++i) {
        const std::string mark = "{" + variant.axes[i].name + "}";
        for (size_t at = text.find(mark); at != std::string::npos;
             at = text.find(mark, at + choice[i]->label.size()))
            text.replace(at, mark.size(), choice[i]->label);
    }
    return text;
}

SweepPoint pointOf(const Sweep& sweep, const SweepVariant& variant, const Choice& choice) {
    SweepPoint point;
    point.name = point.variant = variant.name;
    point.series = withLabels(variant.series, variant, choice);
    point.along = variant.along;
    point.plot = variant.plot;
    point.graph = variant.graph;
    point.ray = variant.ray;
    point.output = variant.output;
    point.settings = variant.settings;
    point.free = variant.free;
    point.exact = variant.exact;
    point.frames = variant.ray && sweep.rays ? sweep.rays->frames : variant.frames.value_or(sweep.frames);
    point.where = variant.where;
    for (size_t i = 0; i < choice.size(); ++i) {
        const SweepAxis& axis = variant.axes[i];
        // "bom.resolution" is "resolution" for people.
        const std::string shown = axis.name.substr(axis.name.find('.') + 1);
        point.name += fmt::format(", {} {}", shown, choice[i]->label);
        point.axes.emplace_back(axis.name, choice[i]->label);
        point.settings.insert(point.settings.end(), choice[i]->settings.begin(), choice[i]->settings.end());
    }
    return point;
}

// What an expansion has come to so far.
struct Expansion {
    std::vector<SweepPoint> points;
    size_t tried = 0, text = 0;
};

[[noreturn]] void failTooMuch(const SweepVariant& variant, size_t most, const char* what) {
    throw InputError(variant.where,
                     fmt::format("the axes multiply to more than {} {} in all; at most that many are {}",
                                 most, what, most == maxSweepPoints ? "measured" : "read"));
}

size_t textOf(const SweepPoint& point) {
    size_t bytes = point.name.size() + point.series.size();
    for (const SweepSetting& setting : point.settings) bytes += sizeof(SweepSetting) + setting.text.size();
    return bytes;
}

// Adds the points of one variant.
void addPoints(const Sweep& sweep, const SweepVariant& variant, Expansion& made) {
    std::vector<size_t> counter(variant.axes.size(), 0);
    while (true) {
        if (++made.tried > maxSweepTried)
            failTooMuch(variant, maxSweepTried, "combinations, excluded ones too,");
        Choice choice;
        for (size_t i = 0; i < counter.size(); ++i) choice.push_back(&variant.axes[i].values[counter[i]]);
        if (!excluded(variant, choice)) {
            made.points.push_back(pointOf(sweep, variant, choice));
            made.text += textOf(made.points.back());
        }
        if (made.points.size() > maxSweepPoints) failTooMuch(variant, maxSweepPoints, "points");
        if (made.text > maxSweepText) failTooMuch(variant, maxSweepText, "bytes of settings");
        size_t axis = counter.size();
        while (axis > 0 && ++counter[axis - 1] == variant.axes[axis - 1].values.size()) counter[--axis] = 0;
        if (axis == 0) return;
    }
}

} // namespace

std::string sweepSlug(const std::string& name, std::set<std::string>& taken) {
    std::string slug;
    for (const char c : name) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
        if (plain)
            slug += c;
        else if (c >= 'A' && c <= 'Z')
            slug += static_cast<char>(c - 'A' + 'a');
        else if (!slug.empty() && slug.back() != '-')
            slug += '-';
    }
    slug = slug.substr(0, 100);
    while (!slug.empty() && (slug.back() == '-' || slug.back() == '.')) slug.pop_back();
    if (slug.empty() || slug.front() == '.') slug = "x" + slug;
    std::string unique = slug;
    for (int i = 2; !taken.insert(unique).second; ++i) unique = fmt::format("{}-{}", slug, i);
    return unique;
}

std::vector<SweepPoint> expandSweep(const Sweep& sweep) {
    Expansion made;
    for (const SweepVariant& variant : sweep.variants) addPoints(sweep, variant, made);
    std::vector<SweepPoint>& points = made.points;
    std::set<std::string> names, slugs{"reference"};
    std::vector<Problem> problems;
    for (SweepPoint& point : points) {
        if (!names.insert(point.name).second)
            problems.push_back({point.where, fmt::format("two points have the name '{}'", point.name)});
        point.slug = sweepSlug(point.name, slugs);
    }
    if (points.empty())
        problems.push_back(
            {Location{sweep.file.string()}, "everything is excluded: nothing is left to measure"});
    if (!problems.empty()) throw InputError(std::move(problems));
    return std::move(points);
}

std::vector<SweepUnit> sweepUnits(const Sweep& sweep, const std::vector<SweepPoint>& points) {
    std::vector<SweepUnit> units;
    std::set<std::string> slugs{"machines", "references", "tuning"}; // they stand beside the units' folders
    for (size_t scene = 0; scene < sweep.scenes.size(); ++scene) {
        const size_t first = units.size();
        for (size_t i = 0; i < points.size(); ++i) {
            auto unit = std::find_if(units.begin() + static_cast<std::ptrdiff_t>(first), units.end(),
                                     [&](const SweepUnit& u) { return u.plot == points[i].plot; });
            if (unit == units.end()) {
                const std::string& name = sweep.scenes[scene].name;
                units.push_back(
                    {static_cast<int>(scene),
                     points[i].plot,
                     {},
                     sweepSlug(points[i].plot.empty() ? name : name + "-" + points[i].plot, slugs)});
                unit = units.end() - 1;
            }
            unit->points.push_back(static_cast<int>(i));
        }
    }
    return units;
}

Shard parseShard(const std::string& text) {
    const auto number = [](std::string_view part) {
        int value = 0;
        const auto [rest, failure] = std::from_chars(part.data(), part.data() + part.size(), value);
        return failure == std::errc() && rest == part.data() + part.size() ? value : 0;
    };
    const size_t slash = text.find('/');
    Shard shard{0, 0};
    if (slash != std::string::npos)
        shard = {number(std::string_view(text).substr(0, slash)),
                 number(std::string_view(text).substr(slash + 1))};
    if (shard.index < 1 || shard.index > shard.count || shard.count > 1'000'000)
        throw InputError(fmt::format("--shard {}: it must be I/N with 1 <= I <= N", text));
    return shard;
}

std::vector<bool> choosePoints(const std::vector<SweepPoint>& points, const std::string& only) {
    std::vector<bool> chosen(points.size(), only.empty());
    std::vector<std::string> names;
    for (size_t i = 0; i < points.size() && !only.empty(); ++i) {
        const SweepPoint& point = points[i];
        chosen[i] = point.name == only || point.variant == only || point.series == only;
        names.insert(names.end(), {point.name, point.variant, point.series});
    }
    if (std::ranges::find(chosen, true) == chosen.end())
        throw InputError(fmt::format("--only {}: there is no such variant{}", only, didYouMean(only, names)));
    return chosen;
}

std::filesystem::path sweepGraphFile(const Sweep& sweep, const std::string& graph) {
    const std::filesystem::path folder = sweep.file.has_parent_path() ? sweep.file.parent_path() : ".";
    const std::filesystem::path shipped = shareFolder() / "graphs";
    std::error_code ignored;
    for (const std::filesystem::path& place : {folder, shipped})
        if (auto file = place / graph; std::filesystem::is_regular_file(file, ignored)) return file;
    std::vector<std::string> names;
    for (const std::filesystem::path& place : {folder, shipped})
        for (const auto& entry : std::filesystem::directory_iterator(place, ignored))
            if (entry.path().extension() == ".json") names.push_back(entry.path().filename().string());
    throw InputError(
        std::filesystem::path(graph).is_absolute()
            ? fmt::format("there is no graph '{}'", graph)
            : fmt::format(
                  "there is no graph '{}' seen from the folder of the sweep file, nor among those that "
                  "come with Kestrel{}",
                  graph, didYouMean(graph, names)));
}

std::filesystem::path sweepSceneFile(const Sweep& sweep, const SweepScene& scene) {
    return sweep.file.parent_path() / scene.source;
}

void checkSweepScenes(const Sweep& sweep) {
    std::vector<Problem> problems;
    std::error_code ignored;
    for (const SweepScene& scene : sweep.scenes)
        if (!scene.source.starts_with("builtin:") &&
            !std::filesystem::exists(sweepSceneFile(sweep, scene), ignored))
            problems.push_back({scene.where, fmt::format("there is no scene file '{}'",
                                                         sweepSceneFile(sweep, scene).string())});
    for (const SweepScene& scene : sweep.scenes) {
        if (!scene.setup.camera || scene.setup.camera->path.empty()) continue;
        const std::string path = located(scene.setup, sweep.file.parent_path()).camera->path;
        if (!std::filesystem::exists(path, ignored))
            problems.push_back({scene.where, fmt::format("there is no file '{}' of a camera's path", path)});
    }
    if (!problems.empty()) throw InputError(std::move(problems));
}

Graph sweepGraph(const Sweep& sweep, const std::string& graph, const std::vector<SweepSetting>& settings,
                 const std::vector<PortRef>& outputs, const Registry& registry, const Location& where) {
    std::vector<Problem> problems;
    const auto add = [&](const InputError& error, const Location& place) {
        for (const Problem& problem : error.problems()) {
            const bool elsewhere = problem.where.line > 0; // in the graph file itself
            problems.push_back(elsewhere ? problem : Problem{place, problem.message});
        }
    };
    Graph result;
    try {
        result = loadGraph(sweepGraphFile(sweep, graph));
    } catch (const InputError& error) {
        add(error, where);
        throw InputError(std::move(problems));
    }
    for (const SweepSetting& setting : settings) try {
            applySetting(result, registry, setting.text);
        } catch (const InputError& error) {
            for (const Problem& problem : error.problems())
                problems.push_back({setting.where, fmt::format("'{}': {}", setting.text, problem.message)});
        }
    result.outputs.clear();
    for (const PortRef& output : outputs) result.outputs.push_back({output, where});
    for (const Problem& problem : validate(result, registry)) {
        const bool ofSetting = problem.where.file.starts_with("--set ");
        problems.push_back(ofSetting ? Problem{where, problem.message} : problem);
    }
    if (!problems.empty()) throw InputError(std::move(problems));
    return result;
}

SweepPoint exactOf(const SweepPoint& point) {
    SweepPoint exact = point;
    exact.settings.insert(exact.settings.end(), point.exact.begin(), point.exact.end());
    return exact;
}

void checkSweep(const Sweep& sweep, const std::vector<SweepPoint>& points, const Registry& registry) {
    std::vector<Problem> problems;
    std::set<std::string> told; // the points of a variant share its mistakes
    const auto check = [&](const std::string& graph, const std::vector<SweepSetting>& settings,
                           const std::vector<PortRef>& outputs, const Location& where) {
        try {
            static_cast<void>(sweepGraph(sweep, graph, settings, outputs, registry, where));
        } catch (const InputError& error) {
            for (const Problem& problem : error.problems())
                if (told.insert(problem.text()).second) problems.push_back(problem);
        }
    };
    if (sweep.reference) {
        const SweepReference& reference = *sweep.reference;
        std::vector<PortRef> outputs{reference.output};
        if (reference.mask) outputs.push_back(*reference.mask);
        check(reference.graph, reference.settings, outputs, reference.where);
    }
    if (sweep.rays)
        check(sweep.rays->graph, sweep.rays->settings, {sweep.rays->hits, sweep.rays->rays},
              sweep.rays->where);
    for (const SweepPoint& point : points) {
        std::vector<PortRef> outputs{point.output};
        if (point.ray && sweep.rays) outputs.push_back(sweep.rays->rays);
        check(point.graph, point.settings, outputs, point.where);
        if (!point.exact.empty()) check(point.graph, exactOf(point).settings, outputs, point.where);
    }
    if (!problems.empty()) throw InputError(std::move(problems));
}

} // namespace kestrel
