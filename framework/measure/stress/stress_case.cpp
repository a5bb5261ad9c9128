#include "measure/stress/stress_case.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace kestrel {
namespace {

constexpr std::string_view length = "scene units"; // of properties that are lengths of the scene

// As JSON would have it: whole numbers where the property is one.
Value valueOf(const PropertyInfo& property, double value) {
    const double held = std::clamp(value, property.minimum, property.maximum);
    if (property.kind == PropertyKind::Int) return static_cast<std::int64_t>(std::llround(held));
    return held;
}

double numberOf(const Value& value) {
    if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
    const auto* number = std::get_if<double>(&value);
    return number != nullptr ? *number : 0;
}

bool isNumber(const PropertyInfo& property) {
    return property.kind == PropertyKind::Int || property.kind == PropertyKind::Float;
}

const Value& given(const GraphPass& pass, const PropertyInfo& property) {
    for (const auto& [name, value] : pass.properties)
        if (name == property.name) return value;
    return property.defaultValue;
}

void set(GraphPass& pass, const std::string& name, Value value) {
    for (auto& [held, old] : pass.properties)
        if (held == name) {
            old = std::move(value);
            return;
        }
    pass.properties.emplace_back(name, std::move(value));
}

} // namespace

std::string_view stressKindName(StressKind kind) {
    constexpr std::array<std::string_view, 11> names = {
        "numbers", "scale", "place", "turn", "depth", "frame", "geometry", "layers", "light", "rays", "time"};
    return names.at(static_cast<size_t>(kind));
}

std::string_view stressExpectsName(StressExpects expects) {
    constexpr std::array<std::string_view, 6> names = {"finite", "same",     "mirrored",
                                                       "order",  "recovery", "energy"};
    return names.at(static_cast<size_t>(expects));
}

const std::vector<StressCase>& stressCases() {
    static const std::vector<StressCase> cases = [] {
        std::vector<StressCase> all;
        addRunCases(all);
        addSpaceCases(all);
        addViewCases(all);
        addGeometryCases(all);
        addLightCases(all);
        std::ranges::stable_sort(all, {}, &StressCase::kind);
        return all;
    }();
    return cases;
}

std::vector<size_t> chooseStressCases(const std::string& only) {
    std::vector<size_t> chosen;
    std::vector<std::string> names;
    for (size_t i = 0; i < stressCases().size(); ++i) {
        const StressCase& one = stressCases()[i];
        const std::string kind(stressKindName(one.kind));
        if (only.empty() || only == one.name || only == kind) chosen.push_back(i);
        names.push_back(one.name);
        if (std::ranges::find(names, kind) == names.end()) names.push_back(kind);
    }
    if (chosen.empty())
        throw InputError(fmt::format("--only {}: there is no such case or kind of cases{}; --list tells them",
                                     only, didYouMean(only, names)));
    return chosen;
}

double closedRoomLight(const Graph& graph, const Registry& registry, double reflectance) {
    double bounces = 1;
    for (const GraphPass& pass : graph.passes)
        if (const PassType* type = registry.find(pass.type); type != nullptr)
            if (const PropertyInfo* property = type->property("bounces"); property != nullptr)
                bounces = std::max(bounces, numberOf(given(pass, *property)));
    double light = 1, share = 1;
    for (int i = 0; i < static_cast<int>(bounces); ++i) light += share *= reflectance;
    return light;
}

Graph stressGraph(Graph graph, const Registry& registry, double scale,
                  std::span<const StressProperty> properties) {
    for (GraphPass& pass : graph.passes) {
        const PassType* type = registry.find(pass.type);
        if (type == nullptr) continue;
        for (const PropertyInfo& property : type->properties) {
            if (!isNumber(property)) continue;
            if (scale != 1 && property.unit == length)
                set(pass, property.name, valueOf(property, scale * numberOf(given(pass, property))));
            for (const StressProperty& change : properties) {
                if (!change.name.empty() && change.name != property.name) continue;
                if (!change.unit.empty() && change.unit != property.unit) continue;
                const double value = change.to == StressProperty::To::Least  ? property.minimum
                                     : change.to == StressProperty::To::Most ? property.maximum
                                                                             : change.value;
                set(pass, property.name, valueOf(property, value));
            }
        }
    }
    return graph;
}

} // namespace kestrel
