// `--set`: changes a property or a variable, or moves an edge.
#include "graph/graph.h"
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace kestrel {
namespace {

template<class Number>
std::optional<Number> wholeText(std::string_view text) {
    Number number{};
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (failure != std::errc() || end != text.data() + text.size()) return {};
    return number;
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    return text;
}

// "1,2,3" or "[1, 2, 3]".
std::optional<std::vector<double>> numbersOf(std::string_view text) {
    text = trimmed(text);
    if (text.starts_with('[') && text.ends_with(']') && text.size() >= 2)
        text = text.substr(1, text.size() - 2);
    std::vector<double> numbers;
    while (true) {
        const size_t comma = text.find(',');
        const auto number = wholeText<double>(trimmed(text.substr(0, comma)));
        if (!number) return {};
        numbers.push_back(*number);
        if (comma == std::string_view::npos) return numbers;
        text.remove_prefix(comma + 1);
    }
}

// The text as the property's kind asks; a text that is not of that kind stays a string (and is refused with
// it).
Value valueOf(const PropertyInfo& property, const std::string& text) {
    switch (property.kind) {
    case PropertyKind::Bool:
        if (text == "true" || text == "false") return text == "true";
        break;
    case PropertyKind::Int:
        if (const auto number = wholeText<std::int64_t>(text)) return *number;
        // 128.0 is a whole number too.
        if (const auto number = wholeText<double>(text); number && *number == std::floor(*number))
            return *number;
        break;
    case PropertyKind::Float:
        if (const auto number = wholeText<std::int64_t>(text)) return *number;
        if (const auto number = wholeText<double>(text)) return *number;
        break;
    case PropertyKind::Vector:
        if (auto numbers = numbersOf(text)) return std::move(*numbers);
        break;
    case PropertyKind::Choice:
    case PropertyKind::Text:
        break;
    }
    return text;
}

class Setter {
public:
    Setter(Graph& graph, const Registry& registry, const std::string& setting)
        : graph_(graph)
        , registry_(registry)
        , where_{"--set " + setting} {}

    void apply(const std::string& setting) {
        const size_t equals = setting.find('=');
        const std::string_view left = std::string_view(setting).substr(0, equals);
        const auto target = parsePortRef(left);
        if (equals != std::string::npos && !target && isGraphName(left)) {
            setVariable(left, setting.substr(equals + 1));
            return;
        }
        if (equals == std::string::npos || !target)
            fail("must be pass.property=value, variable=value, pass.input=pass.output or pass.input=");
        GraphPass* pass = graph_.find(target->pass);
        if (pass == nullptr) failPass(target->pass);
        const PassType& type = typeOf(*pass);
        const std::string value = setting.substr(equals + 1);
        if (const PropertyInfo* property = type.property(target->port)) {
            setProperty(*pass, *property, value);
        } else if (const PortInfo* port = type.port(target->port)) {
            if (port->direction != PortDirection::Input)
                fail(fmt::format("'{}' is {}; only properties and inputs can be set", target->text(),
                                 port->direction == PortDirection::Output ? "an output" : "internal"));
            moveEdge(*target, *port, value);
        } else {
            std::vector<std::string> names = type.propertyNames();
            for (std::string& name : type.portNames(PortDirection::Input)) names.push_back(std::move(name));
            fail(fmt::format("pass '{}' ({}) has no property or input '{}'{}", pass->name, type.name,
                             target->port, didYouMean(target->port, names)));
        }
    }

private:
    [[noreturn]] void fail(const std::string& message) const { throw InputError(where_, message); }
    [[noreturn]] void failPass(const std::string& name) const {
        std::vector<std::string> names;
        for (const GraphPass& pass : graph_.passes) names.push_back(pass.name);
        fail(fmt::format("there is no pass '{}'{}", name, didYouMean(name, names)));
    }
    [[nodiscard]] const PassType& typeOf(const GraphPass& pass) const {
        const PassType* type = registry_.find(pass.type);
        if (type == nullptr)
            fail(fmt::format("pass '{}' has the unknown type '{}'{}", pass.name, pass.type,
                             didYouMean(pass.type, registry_.names())));
        return *type;
    }

    // The text is read as the first property asks that follows the variable; the others are held against it
    // by validate(), as they are when a file gives it.
    void setVariable(std::string_view name, const std::string& text) {
        if (graph_.variable(name) == nullptr) {
            std::vector<std::string> names;
            for (const GraphVariable& variable : graph_.variables) names.push_back(variable.name);
            fail(fmt::format("the graph has no variable '{}'{}", name, didYouMean(std::string(name), names)));
        }
        for (const GraphPass& pass : graph_.passes)
            for (const auto& [property, variable] : pass.bound)
                if (const PropertyInfo* info = variable == name ? typeOf(pass).property(property) : nullptr) {
                    Value value = valueOf(*info, text);
                    refuseMistake(pass, *info, value, text);
                    graph_.setVariable(name, value);
                    return;
                }
        fail(fmt::format("no property follows the variable '{}'", name));
    }

    void refuseMistake(const GraphPass& pass, const PropertyInfo& property, const Value& value,
                       const std::string& text) const {
        const auto mistake = valueMistake(property, value);
        if (!mistake) return;
        // A string that was not understood is shown as it was typed, not as "a string".
        std::string message =
            fmt::format("property '{}' of pass '{}' {}", property.name, pass.name, *mistake);
        const std::string tail = ", not a string";
        if (std::holds_alternative<std::string>(value) && message.ends_with(tail))
            message.replace(message.size() - tail.size(), tail.size(), fmt::format(", not '{}'", text));
        fail(message);
    }

    void setProperty(GraphPass& pass, const PropertyInfo& property, const std::string& text) {
        Value value = valueOf(property, text);
        refuseMistake(pass, property, value, text);
        pass.bound.erase(property.name);
        pass.propertyWhere[property.name] = where_;
        for (auto& [name, old] : pass.properties) {
            if (name != property.name) continue;
            old = std::move(value);
            return;
        }
        pass.properties.emplace_back(property.name, std::move(value));
    }

    void moveEdge(const PortRef& input, const PortInfo& port, const std::string& source) {
        if (source.empty()) {
            std::erase_if(graph_.edges, [&](const GraphEdge& edge) { return edge.to == input; });
            return;
        }
        const auto output = parsePortRef(source);
        if (!output) fail(fmt::format("an input is fed by \"pass.output\", not by '{}'", source));
        const GraphPass* producer = graph_.find(output->pass);
        if (producer == nullptr) failPass(output->pass);
        const PassType& type = typeOf(*producer);
        const PortInfo* from = type.port(output->port);
        if (from == nullptr || from->direction != PortDirection::Output)
            fail(fmt::format("pass '{}' ({}) has no output '{}'{}", producer->name, type.name, output->port,
                             didYouMean(output->port, type.portNames(PortDirection::Output))));
        if (from->kind != port.kind)
            fail(fmt::format("a {} cannot feed a {} port: '{}' -> '{}'", portKindName(from->kind),
                             portKindName(port.kind), output->text(), input.text()));
        for (GraphEdge& edge : graph_.edges) {
            if (edge.to != input) continue;
            edge = {*output, input, where_};
            return;
        }
        graph_.edges.push_back({*output, input, where_});
    }

    Graph& graph_;
    const Registry& registry_;
    Location where_;
};

} // namespace

void applySetting(Graph& graph, const Registry& registry, const std::string& setting) {
    Setter(graph, registry, setting).apply(setting);
}

} // namespace kestrel
