// The table of pass types: one place from which loading, saving, --set, sweep axes, editor, schema and
// documentation take ports and properties.
#pragma once
#include "core/error.h"
#include "graph/content.h"
#include "graph/pass.h"
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace kestrel {

struct PortInfo {
    std::string name;
    PortKind kind = PortKind::Texture;
    PortDirection direction = PortDirection::Input;
    bool optional = false; // of an input
    std::string description;
    Content content = {};
    // An input of the same pass whose extent and camera this input must share; empty: none. Held where both
    // are connected.
    std::string sameExtentAs = {};
    // The range of an output's values, where it is known; `render --check-finite` holds them against it.
    double minimum = -std::numeric_limits<double>::infinity(),
           maximum = std::numeric_limits<double>::infinity();
};

enum class PropertyKind : std::uint8_t { Bool, Int, Float, Choice, Text, Vector };

struct PropertyInfo {
    std::string name;
    PropertyKind kind = PropertyKind::Float;
    Value defaultValue; // the default, taken from a default-constructed pass
    double minimum = -std::numeric_limits<double>::infinity(),
           maximum = std::numeric_limits<double>::infinity();
    std::vector<std::string> choices; // of Choice
    int components = 0;               // of Vector
    std::string unit, description;
    std::function<void(Pass&, const Value&)> set; // the value is of the right kind and in range
    std::function<Value(const Pass&)> get;
};

struct PassType {
    std::string name, description;
    std::vector<PortInfo> ports;
    std::vector<PropertyInfo> properties;
    std::function<std::unique_ptr<Pass>()> make;
    std::string plugin; // the library that it came from; set by the loader
    // Tells one registration from every other, also of the same name: a pass object belongs to that which
    // made it. Set by the registry.
    std::uint64_t instance = 0;

    [[nodiscard]] const PortInfo* port(std::string_view portName) const;
    [[nodiscard]] const PropertyInfo* property(std::string_view propertyName) const;
    [[nodiscard]] std::vector<std::string> portNames(PortDirection direction) const;
    [[nodiscard]] std::vector<std::string> propertyNames() const;
};

// What is wrong with `value` as a value of this property (kind, range, choice with its near name): a sentence
// that begins with "must be". Nothing if it may be set.
std::optional<std::string> valueMistake(const PropertyInfo& property, const Value& value);

// Names of passes, ports and properties: [a-z][a-z0-9_]*, at most 64 letters, without "__" and not ending in
// "_": they become file names, debug labels and parts of GLSL names.
bool isGraphName(std::string_view name);

class Registry {
public:
    // Throws InputError if the name is taken (says by which plugin), a port or property name occurs twice or
    // is no such name, or a default is not a legal value of its property.
    void add(PassType type);
    // Puts a type in the place of the one of its name, or adds it: its plugin was built anew. Throws as add()
    // does but for the name. Pass objects of the type before stay as they are; whoever compiles a graph makes
    // new ones.
    void replace(PassType type);
    [[nodiscard]] const PassType* find(std::string_view name) const;
    [[nodiscard]] const std::vector<PassType>& types() const { return types_; } // sorted by name
    [[nodiscard]] std::vector<std::string> names() const;
    // Folders with shaders that plugins bring along.
    std::vector<std::filesystem::path> shaderFolders;

private:
    // Throws InputError with `problems` and what else is wrong with the type, if there is anything.
    static void check(const PassType& type, std::vector<Problem> problems);
    void insert(PassType type);
    std::vector<PassType> types_;
};

// Builds a PassType from pointers to members: defaults come from the members' initialisers, so that there is
// one source of them.
//
//     registry.add(Describe<Roma>("Roma", "Ray-aligned occupancy map array")
//                      .input("occupancy", PortKind::Buffer, "Base occupancy map")
//                      .output("tracer", PortKind::Tracer, "Traces through the rotated maps")
//                      .number("directions", &Roma::directions, 4, 256, "maps", "Angular resolution"));
template<class T>
class Describe {
public:
    Describe(std::string name, std::string description) {
        type_.name = std::move(name);
        type_.description = std::move(description);
        type_.make = [] { return std::make_unique<T>(); };
    }
    Describe& input(std::string name, PortKind kind, std::string description) {
        return port(std::move(name), kind, PortDirection::Input, false, std::move(description));
    }
    Describe& optionalInput(std::string name, PortKind kind, std::string description) {
        return port(std::move(name), kind, PortDirection::Input, true, std::move(description));
    }
    Describe& output(std::string name, PortKind kind, std::string description) {
        return port(std::move(name), kind, PortDirection::Output, false, std::move(description));
    }
    // A texture with display-referred values (sRGB code values).
    Describe& displayOutput(std::string name, std::string description) {
        port(std::move(name), PortKind::Texture, PortDirection::Output, false, std::move(description));
        return carries({.channels = 3, .space = Space::Display});
    }
    // What the port described last carries.
    Describe& carries(Content content) {
        type_.ports.back().content = std::move(content);
        return *this;
    }
    // The input described last must have the extent and the camera of this one.
    Describe& sameExtentAs(std::string input) {
        type_.ports.back().sameExtentAs = std::move(input);
        return *this;
    }
    // The values of the port described last lie within [minimum, maximum].
    Describe& range(double minimum, double maximum) {
        type_.ports.back().minimum = minimum;
        type_.ports.back().maximum = maximum;
        return *this;
    }
    Describe& internal(std::string name, PortKind kind, std::string description) {
        return port(std::move(name), kind, PortDirection::Internal, false, std::move(description));
    }
    // A number, whole or not by the member's type; the range is inclusive.
    template<class Number>
    requires std::is_arithmetic_v<Number> Describe& number(std::string name, Number T::*member,
                                                           double minimum, double maximum, std::string unit,
                                                           std::string description) {
        PropertyInfo info;
        info.name = std::move(name);
        info.kind = std::is_integral_v<Number> ? PropertyKind::Int : PropertyKind::Float;
        info.minimum = minimum;
        info.maximum = maximum;
        info.unit = std::move(unit);
        info.description = std::move(description);
        info.set = [member](Pass& pass, const Value& value) {
            static_cast<T&>(pass).*member = std::holds_alternative<std::int64_t>(value)
                                                ? static_cast<Number>(std::get<std::int64_t>(value))
                                                : static_cast<Number>(std::get<double>(value));
        };
        info.get = [member](const Pass& pass) -> Value {
            if constexpr (std::is_integral_v<Number>)
                return static_cast<std::int64_t>(static_cast<const T&>(pass).*member);
            else
                return static_cast<double>(static_cast<const T&>(pass).*member);
        };
        return property(std::move(info));
    }
    Describe& flag(std::string name, bool T::*member, std::string description) {
        PropertyInfo info;
        info.name = std::move(name);
        info.kind = PropertyKind::Bool;
        info.description = std::move(description);
        info.set = [member](Pass& pass, const Value& value) {
            static_cast<T&>(pass).*member = std::get<bool>(value);
        };
        info.get = [member](const Pass& pass) -> Value { return static_cast<const T&>(pass).*member; };
        return property(std::move(info));
    }
    // An enumeration whose values 0, 1, … have these names.
    template<class Enum>
    requires std::is_enum_v<Enum> Describe& choice(std::string name, Enum T::*member,
                                                   const std::vector<std::string>& choices,
                                                   std::string description) {
        PropertyInfo info;
        info.name = std::move(name);
        info.kind = PropertyKind::Choice;
        info.choices = choices;
        info.description = std::move(description);
        info.set = [member, choices](Pass& pass, const Value& value) {
            const auto& text = std::get<std::string>(value);
            for (size_t i = 0; i < choices.size(); ++i)
                if (choices[i] == text) static_cast<T&>(pass).*member = static_cast<Enum>(i);
        };
        info.get = [member, choices](const Pass& pass) -> Value {
            return choices.at(static_cast<size_t>(static_cast<const T&>(pass).*member));
        };
        return property(std::move(info));
    }
    Describe& text(std::string name, std::string T::*member, std::string description) {
        PropertyInfo info;
        info.name = std::move(name);
        info.kind = PropertyKind::Text;
        info.description = std::move(description);
        info.set = [member](Pass& pass, const Value& value) {
            static_cast<T&>(pass).*member = std::get<std::string>(value);
        };
        info.get = [member](const Pass& pass) -> Value { return static_cast<const T&>(pass).*member; };
        return property(std::move(info));
    }
    // A vector of 2, 3 or 4 numbers; the range holds for each component.
    template<int N>
    Describe& vector(std::string name, glm::vec<N, float> T::*member, double minimum, double maximum,
                     std::string unit, std::string description) {
        PropertyInfo info;
        info.name = std::move(name);
        info.kind = PropertyKind::Vector;
        info.components = N;
        info.minimum = minimum;
        info.maximum = maximum;
        info.unit = std::move(unit);
        info.description = std::move(description);
        info.set = [member](Pass& pass, const Value& value) {
            const auto& numbers = std::get<std::vector<double>>(value);
            for (int i = 0; i < N; ++i)
                (static_cast<T&>(pass).*member)[i] = static_cast<float>(numbers.at(static_cast<size_t>(i)));
        };
        info.get = [member](const Pass& pass) -> Value {
            std::vector<double> numbers;
            for (int i = 0; i < N; ++i) numbers.push_back((static_cast<const T&>(pass).*member)[i]);
            return numbers;
        };
        return property(std::move(info));
    }
    operator PassType() const { return type_; } // NOLINT: the builder stands for what it builds

private:
    Describe& port(std::string name, PortKind kind, PortDirection direction, bool optional,
                   std::string description) {
        type_.ports.push_back({std::move(name), kind, direction, optional, std::move(description)});
        return *this;
    }
    Describe& property(PropertyInfo info) {
        info.defaultValue = info.get(T());
        type_.properties.push_back(std::move(info));
        return *this;
    }
    PassType type_;
};

} // namespace kestrel
