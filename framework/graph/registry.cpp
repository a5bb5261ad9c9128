#include "graph/registry.h"
#include "core/error.h"
#include "graph/value_text.h"
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <set>

namespace kestrel {
namespace {

template<class Item>
const Item* byName(const std::vector<Item>& items, std::string_view name) {
    const auto found =
        std::find_if(items.begin(), items.end(), [&](const Item& item) { return item.name == name; });
    return found == items.end() ? nullptr : &*found;
}

std::string origin(const PassType& type) {
    return type.plugin.empty() ? std::string("Kestrel itself") : fmt::format("plugin '{}'", type.plugin);
}

std::optional<std::string> rangeMistake(const PropertyInfo& property, double number) {
    if (std::isfinite(number) && number >= property.minimum && number <= property.maximum) return {};
    const bool below = std::isfinite(property.minimum), above = std::isfinite(property.maximum);
    const std::string unit = property.unit.empty() ? std::string() : " " + property.unit;
    std::string range = "a finite number";
    if (below && above)
        range =
            fmt::format("from {} to {}{}", numberText(property.minimum), numberText(property.maximum), unit);
    else if (below)
        range = fmt::format("at least {}{}", numberText(property.minimum), unit);
    else if (above)
        range = fmt::format("at most {}{}", numberText(property.maximum), unit);
    return fmt::format("must be {}, not {}", range, numberText(number));
}

// The kinds of value that a file can give, in words.
std::string kindOf(const Value& value) {
    constexpr std::array names = {"true or false", "a whole number", "a number", "a string",
                                  "an array of numbers"};
    return names.at(value.index());
}

// As JSON schemas have it: 128.0 is a whole number.
bool isWhole(double number) { return std::abs(number) <= 9007199254740992 && number == std::floor(number); }

std::optional<std::string> wrongKind(const std::string& wanted, const Value& value) {
    return fmt::format("must be {}, not {}", wanted, kindOf(value));
}

} // namespace

const PortInfo* PassType::port(std::string_view portName) const { return byName(ports, portName); }

const PropertyInfo* PassType::property(std::string_view propertyName) const {
    return byName(properties, propertyName);
}

std::vector<std::string> PassType::portNames(PortDirection direction) const {
    std::vector<std::string> names;
    for (const PortInfo& info : ports)
        if (info.direction == direction) names.push_back(info.name);
    return names;
}

std::vector<std::string> PassType::propertyNames() const {
    std::vector<std::string> names;
    for (const PropertyInfo& info : properties) names.push_back(info.name);
    return names;
}

bool isGraphName(std::string_view name) {
    if (name.empty() || name.size() > 64 || name.back() == '_' || name.front() < 'a' || name.front() > 'z')
        return false;
    if (name.find("__") != std::string_view::npos) return false;
    return std::all_of(name.begin(), name.end(), [](char letter) {
        return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || letter == '_';
    });
}

std::optional<std::string> valueMistake(const PropertyInfo& property, const Value& value) {
    switch (property.kind) {
    case PropertyKind::Bool:
        if (!std::holds_alternative<bool>(value)) return wrongKind("true or false", value);
        return {};
    case PropertyKind::Int:
        if (const auto* number = std::get_if<double>(&value); number != nullptr && isWhole(*number))
            return rangeMistake(property, *number);
        if (!std::holds_alternative<std::int64_t>(value)) return wrongKind("a whole number", value);
        return rangeMistake(property, static_cast<double>(std::get<std::int64_t>(value)));
    case PropertyKind::Float:
        if (const auto* whole = std::get_if<std::int64_t>(&value))
            return rangeMistake(property, static_cast<double>(*whole));
        if (!std::holds_alternative<double>(value)) return wrongKind("a number", value);
        return rangeMistake(property, std::get<double>(value));
    case PropertyKind::Choice: {
        const auto* text = std::get_if<std::string>(&value);
        if (text == nullptr)
            return wrongKind(fmt::format("one of {}", fmt::join(property.choices, ", ")), value);
        if (std::find(property.choices.begin(), property.choices.end(), *text) != property.choices.end())
            return {};
        return fmt::format("must be one of {}, not '{}'{}", fmt::join(property.choices, ", "), *text,
                           didYouMean(*text, property.choices));
    }
    case PropertyKind::Text:
        if (!std::holds_alternative<std::string>(value)) return wrongKind("a string", value);
        return {};
    case PropertyKind::Vector: {
        const auto* numbers = std::get_if<std::vector<double>>(&value);
        if (numbers == nullptr)
            return wrongKind(fmt::format("an array of {} numbers", property.components), value);
        if (numbers->size() != static_cast<size_t>(property.components))
            return fmt::format("must be an array of {} numbers, not of {}", property.components,
                               numbers->size());
        for (const double number : *numbers)
            if (auto mistake = rangeMistake(property, number)) return mistake;
        return {};
    }
    }
    return {};
}

void Registry::check(const PassType& type, std::vector<Problem> problems) {
    const auto note = [&](const std::string& message) {
        problems.push_back({{}, fmt::format("pass type '{}' of {}: {}", type.name, origin(type), message)});
    };
    std::set<std::string> names;
    const auto noteName = [&](const std::string& name, const char* what) {
        if (!isGraphName(name))
            note(fmt::format("the {} name '{}' is not lower_case letters, digits and single underscores",
                             what, name));
        if (!names.insert(name).second)
            note(fmt::format("'{}' occurs twice among its ports and properties", name));
    };
    for (const PortInfo& port : type.ports) {
        noteName(port.name, "port");
        if (port.sameExtentAs.empty()) continue;
        const PortInfo* other = type.port(port.sameExtentAs);
        if (port.direction != PortDirection::Input || other == nullptr ||
            other->direction != PortDirection::Input || isModule(port.kind) || isModule(other->kind))
            note(fmt::format(
                "'{}' cannot have the extent of '{}': both must be textures or buffers that are read",
                port.name, port.sameExtentAs));
    }
    for (const PropertyInfo& property : type.properties) {
        noteName(property.name, "property");
        if (const auto mistake = valueMistake(property, property.defaultValue))
            note(fmt::format("the default of '{}' {}", property.name, *mistake));
    }
    if (!problems.empty()) throw InputError(std::move(problems));
}

void Registry::add(PassType type) {
    std::vector<Problem> problems;
    if (const PassType* taken = find(type.name))
        problems.push_back({{},
                            fmt::format("pass type '{}' of {}: the name is taken by {}", type.name,
                                        origin(type), origin(*taken))});
    check(type, std::move(problems));
    insert(std::move(type));
}

void Registry::replace(PassType type) {
    check(type, {});
    std::erase_if(types_, [&](const PassType& old) { return old.name == type.name; });
    insert(std::move(type));
}

void Registry::insert(PassType type) {
    static std::atomic<std::uint64_t> registrations{0};
    type.instance = ++registrations;
    const auto place =
        std::lower_bound(types_.begin(), types_.end(), type.name,
                         [](const PassType& one, const std::string& name) { return one.name < name; });
    types_.insert(place, std::move(type));
}

const PassType* Registry::find(std::string_view name) const { return byName(types_, name); }

std::vector<std::string> Registry::names() const {
    std::vector<std::string> names;
    for (const PassType& type : types_) names.push_back(type.name);
    return names;
}

} // namespace kestrel
