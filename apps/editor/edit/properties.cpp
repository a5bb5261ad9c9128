#include "edit/properties.h"
#include "edit/lookup.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel::edit {
namespace {

void refuseMistake(const Registry& registry, const GraphPass& pass, const std::string& property,
                   const Value& value) {
    if (const auto mistake = valueMistake(propertyOf(registry, pass, property), value))
        refuse(fmt::format("property '{}' of pass '{}' {}", property, pass.name, *mistake));
}

void give(GraphPass& pass, const std::string& property, const Value& value) {
    for (auto& [name, held] : pass.properties)
        if (name == property) {
            held = value;
            return;
        }
    pass.properties.emplace_back(property, value);
}

GraphVariable& variableOf(Graph& graph, const std::string& name) {
    for (GraphVariable& variable : graph.variables)
        if (variable.name == name) return variable;
    refuse(fmt::format("there is no variable '{}'", name));
}

} // namespace

Value propertyValue(const GraphPass& pass, const PropertyInfo& property) {
    for (const auto& [name, value] : pass.properties)
        if (name == property.name) return value;
    return property.defaultValue;
}

bool isGiven(const GraphPass& pass, const std::string& property) {
    return std::any_of(pass.properties.begin(), pass.properties.end(),
                       [&](const auto& given) { return given.first == property; });
}

void setProperty(Graph& graph, const Registry& registry, const std::string& pass, const std::string& property,
                 const Value& value) {
    GraphPass& target = passOf(graph, pass);
    const auto follows = target.bound.find(property);
    if (follows == target.bound.end()) {
        refuseMistake(registry, target, property, value);
        give(target, property, value);
        return;
    }
    const std::string variable = follows->second;
    for (const GraphPass& other : graph.passes)
        for (const auto& [name, followed] : other.bound)
            if (followed == variable) refuseMistake(registry, other, name, value);
    graph.setVariable(variable, value);
}

void resetProperty(Graph& graph, const std::string& pass, const std::string& property) {
    GraphPass& target = passOf(graph, pass);
    target.bound.erase(property);
    target.propertyWhere.erase(property);
    std::erase_if(target.properties, [&](const auto& given) { return given.first == property; });
}

void followVariable(Graph& graph, const Registry& registry, const std::string& pass,
                    const std::string& property, const std::string& variable) {
    GraphPass& target = passOf(graph, pass);
    const PropertyInfo& info = propertyOf(registry, target, property);
    if (const GraphVariable* held = graph.variable(variable)) {
        refuseMistake(registry, target, property, held->value);
        give(target, property, held->value);
    } else {
        if (!isGraphName(variable))
            refuse(fmt::format(
                "'{}' is no name of a variable: lower_case letters, digits and single underscores, "
                "a letter first",
                variable));
        if (graph.variables.size() >= maxGraphVariables)
            refuse(fmt::format("the graph has {} variables; it may have no more", maxGraphVariables));
        const Value value = propertyValue(target, info);
        graph.variables.push_back({variable, value, {}});
        give(target, property, value);
    }
    target.bound[property] = variable;
}

void leaveVariable(Graph& graph, const std::string& pass, const std::string& property) {
    passOf(graph, pass).bound.erase(property);
}

void renameVariable(Graph& graph, const std::string& from, const std::string& to) {
    GraphVariable& variable = variableOf(graph, from);
    if (from == to) return;
    if (!isGraphName(to)) refuse(fmt::format("'{}' is no name of a variable", to));
    if (graph.variable(to) != nullptr) refuse(fmt::format("there is a variable '{}' already", to));
    variable.name = to;
    for (GraphPass& pass : graph.passes)
        for (auto& [property, followed] : pass.bound)
            if (followed == from) followed = to;
}

void removeVariable(Graph& graph, const std::string& variable) {
    variableOf(graph, variable);
    for (GraphPass& pass : graph.passes)
        std::erase_if(pass.bound, [&](const auto& follows) { return follows.second == variable; });
    std::erase_if(graph.variables, [&](const GraphVariable& held) { return held.name == variable; });
}

} // namespace kestrel::edit
