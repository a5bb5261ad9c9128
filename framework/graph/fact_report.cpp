// What facts leave out, as text, as a table and as JSON.
#include "graph/fact_effects.h"
#include "scene/fact_list.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>
#include <nlohmann/json.hpp>

namespace kestrel {
namespace {

using Out = nlohmann::ordered_json;

std::vector<std::string_view> causeNames(Causes causes) {
    constexpr std::pair<Causes, std::string_view> names[] = {
        {Causes::Frame, "frame"},       {Causes::Camera, "camera"},         {Causes::Cameras, "cameras"},
        {Causes::Geometry, "geometry"}, {Causes::Transforms, "transforms"}, {Causes::Lights, "lights"}};
    std::vector<std::string_view> found;
    for (const auto& [cause, name] : names)
        if (any(causes & cause)) found.push_back(name);
    return found;
}

std::string quoted(const std::set<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "`" : ", `") + name + "`";
    return text;
}

constexpr std::string_view idleFrames = "frames in which nothing else changed";

// The most telling of what a pass leaves out, in few words. What runs less often is told of facts that say
// that something is at rest.
std::string effectText(const FactEffect& effect) {
    const auto fact = std::ranges::find(sceneFactList(), effect.fact, &SceneFact::name);
    const bool moves = fact != sceneFactList().end() && fact->moves;
    std::vector<std::string> parts;
    if (effect.nothingRuns) return "every step";
    for (const auto& [what, why] : effect.leftOut) parts.push_back(what);
    if (parts.empty() && !effect.constants.empty()) parts.push_back(quoted(effect.constants));
    if (parts.empty() && !effect.steps.empty()) parts.push_back("step " + quoted(effect.steps));
    if (parts.empty() && !effect.smaller.empty()) parts.push_back("room of " + quoted(effect.smaller));
    if (parts.empty() && !effect.reads.empty()) parts.push_back("reading " + quoted(effect.reads));
    if (parts.empty() && !effect.defines.empty()) parts.emplace_back("parts of shaders");
    if (moves && effect.once) parts.emplace_back("all frames but the first");
    if (moves && parts.empty()) parts.emplace_back(idleFrames);
    return fmt::format("{}", fmt::join(parts, ", "));
}

// What falls out -> of which passes; in the order of the passes, what is of most passes first.
std::vector<std::pair<std::string, std::vector<std::string>>>
grouped(const std::vector<const FactEffect*>& effects) {
    std::vector<std::pair<std::string, std::vector<std::string>>> groups;
    for (const FactEffect* effect : effects) {
        const std::string text = effectText(*effect);
        if (text.empty()) continue;
        const auto found = std::ranges::find(groups, text, [](const auto& group) { return group.first; });
        if (found != groups.end())
            found->second.push_back(effect->pass);
        else
            groups.push_back({text, {effect->pass}});
    }
    std::ranges::stable_sort(groups, std::greater{}, [](const auto& group) { return group.second.size(); });
    return groups;
}

// By fact, in the order of the effects.
std::vector<std::vector<const FactEffect*>> byFact(const std::vector<FactEffect>& effects) {
    std::vector<std::vector<const FactEffect*>> facts;
    for (const FactEffect& effect : effects) {
        if (facts.empty() || facts.back().front()->fact != effect.fact) facts.emplace_back();
        facts.back().push_back(&effect);
    }
    return facts;
}

} // namespace

std::string factsMarkdown(const std::vector<FactEffect>& effects) {
    std::vector<std::pair<std::string, std::string>> rows; // facts, what falls out
    const auto add = [&](std::string_view fact, const std::string& cell) {
        const auto same = std::ranges::find(rows, cell, [](const auto& row) { return row.second; });
        if (same != rows.end())
            same->first += fmt::format("; {}", fact);
        else
            rows.emplace_back(fact, cell);
    };
    std::set<std::string> told;
    for (const auto& fact : byFact(effects)) {
        std::string cell;
        for (const auto& [what, passes] : grouped(fact)) {
            const std::string names = what == idleFrames ? fmt::format("{} passes", passes.size())
                                                         : fmt::format("`{}`", fmt::join(passes, "`, `"));
            cell += fmt::format("{}{}: {}", cell.empty() ? "" : "; ", what, names);
        }
        if (cell.empty()) continue;
        told.insert(fact.front()->fact);
        add(fact.front()->fact, cell);
    }
    for (const SceneFact& fact : sceneFactList())
        if (!told.contains(std::string(fact.name))) add(fact.name, "nothing");
    std::string text = "| of a scene with | falls out |\n|---|---|\n";
    for (const auto& [facts, cell] : rows) text += fmt::format("| {} | {} |\n", facts, cell);
    return text;
}

std::string factsText(const std::vector<FactEffect>& effects) {
    std::string text;
    for (const auto& fact : byFact(effects)) {
        text += fact.front()->fact + "\n";
        for (const FactEffect* effect : fact) {
            if (effectText(*effect).empty()) continue;
            text += fmt::format("  {:<28} {}", effect->pass, effectText(*effect));
            for (const auto& [what, why] : effect->leftOut) text += fmt::format("; {}: {}", what, why);
            text += "\n";
        }
    }
    return text;
}

std::string factsJson(const std::vector<FactEffect>& effects) {
    Out facts = Out::array();
    for (const auto& fact : byFact(effects)) {
        Out passes = Out::array();
        for (const FactEffect* effect : fact) {
            Out leftOut = Out::array();
            for (const auto& [what, why] : effect->leftOut) leftOut.push_back({{"what", what}, {"why", why}});
            passes.push_back({{"pass", effect->pass},
                              {"nothing_runs", effect->nothingRuns},
                              {"once", effect->once},
                              {"causes", causeNames(effect->causes)},
                              {"steps", effect->steps},
                              {"constants", effect->constants},
                              {"smaller", effect->smaller},
                              {"reads", effect->reads},
                              {"defines", effect->defines},
                              {"left_out", std::move(leftOut)}});
        }
        facts.push_back({{"fact", fact.front()->fact}, {"passes", std::move(passes)}});
    }
    return Out{{"facts", std::move(facts)}}.dump(2, ' ', false, Out::error_handler_t::replace) + "\n";
}

} // namespace kestrel
