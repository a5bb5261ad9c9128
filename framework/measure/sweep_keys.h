// The keys of a sweep file, each told once: name, kind, range, default and sentence. Parser and schema both
// come from here.
#pragma once
#include "core/json.h"
#include "core/problems.h"
#include "measure/sweep_file.h"
#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <nlohmann/json.hpp>

namespace kestrel {

using SchemaJson = nlohmann::ordered_json;

// What is read so far, and every mistake in it.
struct SweepReading {
    std::vector<Problem>& problems;
    Sweep& sweep;
    std::set<std::string> sceneSlugs;

    void note(const Location& where, std::string message) {
        noteProblem(problems, where, std::move(message));
    }
    // Whether a list is short enough to be read; notes it if not.
    bool allows(const Location& where, std::size_t count, std::size_t most, const char* what) {
        if (count > most) note(where, fmt::format("{} {}; at most {} are read", count, what, most));
        return count <= most;
    }
};

// The values that several keys share. Each notes what is wrong, and gives nothing or the value before then.
std::string readSweepText(SweepReading& reading, const Json& json);
std::string readSweepName(SweepReading& reading, const Json& json, const std::string& what);
std::optional<int> readSweepWhole(SweepReading& reading, const Json& json, const std::string& key,
                                  int minimum, int maximum);
std::optional<double> readSweepNumber(SweepReading& reading, const Json& json, const std::string& key,
                                      double minimum, double maximum);
std::optional<PortRef> readSweepPort(SweepReading& reading, const Json& json, const std::string& key);
std::vector<SweepSetting> readSweepSettings(SweepReading& reading, const Json& json);

// The keys of one kind of object that is read into a T. Defaults are the members' initialisers.
template<class T>
class SweepKeys {
public:
    using Read = std::function<void(SweepReading&, const Json&, T&)>;
    struct Key {
        std::string name;
        std::optional<Json::Kind> kind; // checked before `read`; none: `read` says what it must be
        SchemaJson schema;
        Read read;
        bool required = false;
    };

    SweepKeys& text(std::string name, std::string T::*member, const std::string& description) {
        SchemaJson schema = {{"type", "string"}, {"description", description}};
        if (!(T().*member).empty()) schema["default"] = T().*member;
        return custom(std::move(name), Json::Kind::String, std::move(schema),
                      [member](SweepReading& reading, const Json& json, T& into) {
                          into.*member = readSweepText(reading, json);
                      });
    }
    // A text that becomes a label, a key and a part of file names; `what` names it in messages.
    SweepKeys& label(std::string name, std::string T::*member, std::string what,
                     const std::string& description) {
        return custom(
            std::move(name), Json::Kind::String,
            {{"type", "string"}, {"minLength", 1}, {"maxLength", maxSweepName}, {"description", description}},
            [member, what = std::move(what)](SweepReading& reading, const Json& json, T& into) {
                into.*member = readSweepName(reading, json, what);
            });
    }
    SweepKeys& flag(std::string name, bool T::*member, const std::string& description) {
        return custom(std::move(name), Json::Kind::Bool,
                      {{"type", "boolean"}, {"default", T().*member}, {"description", description}},
                      [member](SweepReading&, const Json& json, T& into) { into.*member = json.boolean; });
    }
    // A whole number; a default where the member has one.
    template<class Number>
    SweepKeys& whole(const std::string& name, Number T::*member, int minimum, int maximum,
                     const std::string& description) {
        SchemaJson schema = {
            {"type", "integer"}, {"minimum", minimum}, {"maximum", maximum}, {"description", description}};
        if constexpr (std::is_integral_v<Number>) schema["default"] = T().*member;
        return custom(name, std::nullopt, std::move(schema),
                      [=](SweepReading& reading, const Json& json, T& into) {
                          if (const auto value = readSweepWhole(reading, json, name, minimum, maximum))
                              into.*member = static_cast<Number>(*value);
                      });
    }
    // Any number; a default where the member has one.
    template<class Number>
    SweepKeys& number(const std::string& name, Number T::*member, double minimum, double maximum,
                      const std::string& description) {
        SchemaJson schema = {
            {"type", "number"}, {"minimum", minimum}, {"maximum", maximum}, {"description", description}};
        if constexpr (std::is_arithmetic_v<Number>) schema["default"] = T().*member;
        return custom(name, std::nullopt, std::move(schema),
                      [=](SweepReading& reading, const Json& json, T& into) {
                          if (const auto value = readSweepNumber(reading, json, name, minimum, maximum))
                              into.*member = *value;
                      });
    }
    // One of several texts.
    SweepKeys& choice(const std::string& name, std::string T::*member, const std::vector<std::string>& all,
                      const std::string& what) {
        return custom(name, Json::Kind::String, {{"enum", all}, {"default", T().*member}},
                      [=](SweepReading& reading, const Json& json, T& into) {
                          into.*member = json.text;
                          if (std::find(all.begin(), all.end(), json.text) != all.end()) return;
                          reading.note(json.where, what + " '" + json.text + "' is none of " + nearList(all) +
                                                       didYouMean(json.text, all));
                      });
    }
    template<class Port>
    SweepKeys& port(const std::string& name, Port T::*member, const std::string& description) {
        return custom(name, Json::Kind::String, {{"$ref", "#/$defs/port"}, {"description", description}},
                      [=](SweepReading& reading, const Json& json, T& into) {
                          if (const auto found = readSweepPort(reading, json, name)) into.*member = *found;
                      });
    }
    SweepKeys& settings(std::vector<SweepSetting> T::*member) {
        return custom("set", Json::Kind::Array, {{"$ref", "#/$defs/settings"}},
                      [member](SweepReading& reading, const Json& json, T& into) {
                          into.*member = readSweepSettings(reading, json);
                      });
    }
    SweepKeys& custom(std::string name, std::optional<Json::Kind> kind, SchemaJson schema, Read read) {
        keys_.push_back({std::move(name), kind, std::move(schema), std::move(read)});
        return *this;
    }
    // The key that was added last must be there.
    SweepKeys& required() {
        keys_.back().required = true;
        return *this;
    }

    // Reads them in the order of the table; `what` names the object in messages.
    void read(SweepReading& reading, const Json& json, const std::string& what, T& into) const {
        JsonFields fields(json, what, reading.problems);
        if (json.kind != Json::Kind::Object) return;
        for (const Key& key : keys_) {
            const Json* value = nullptr;
            if (key.kind)
                value = key.required ? fields.required(key.name, *key.kind)
                                     : fields.optional(key.name, *key.kind);
            else
                value = key.required ? fields.required(key.name) : fields.optional(key.name);
            if (value != nullptr) key.read(reading, *value, into);
        }
        fields.refuseOthers();
    }
    [[nodiscard]] SchemaJson schema() const {
        SchemaJson json = {{"type", "object"}}, properties = SchemaJson::object();
        std::vector<std::string> needed;
        for (const Key& key : keys_) {
            properties[key.name] = key.schema;
            if (key.required) needed.push_back(key.name);
        }
        if (!needed.empty()) json["required"] = needed;
        json["properties"] = std::move(properties);
        json["additionalProperties"] = false;
        return json;
    }

private:
    // "a, b and c"
    static std::string nearList(const std::vector<std::string>& all) {
        std::string text;
        for (size_t i = 0; i < all.size(); ++i)
            text += (i == 0 ? "" : i + 1 == all.size() ? " and " : ", ") + all[i];
        return text;
    }
    std::vector<Key> keys_;
};

// An axis in its long form: {"set": ["a.b={}"], "values": [...]}.
struct SweepAxisForm {
    std::vector<SweepSetting> templates;
    const Json* values = nullptr;
};

// A free property in its long form: {"range": [low, high], "logarithmic": true} or {"choices": [...]}.
struct SweepFreeForm {
    const Json* range = nullptr;
    const Json* choices = nullptr;
    bool logarithmic = false;
};

const SweepKeys<Sweep>& sweepKeys();
const SweepKeys<Sweep>& sweepPlotKeys();
const SweepKeys<SweepScene>& sweepSceneKeys();
const SweepKeys<SweepReference>& sweepReferenceKeys();
const SweepKeys<SweepRays>& sweepRaysKeys();
const SweepKeys<SweepVariant>& sweepVariantKeys();
const SweepKeys<SweepAxisForm>& sweepAxisKeys();
const SweepKeys<SweepAxisValue>& sweepAxisValueKeys();
const SweepKeys<SweepFreeForm>& sweepFreeKeys();
const SweepKeys<SweepTuning>& sweepTuningKeys();

// Readers of what is more than one value (sweep_file.cpp, sweep_axes.cpp, sweep_free.cpp).
void readSweepSize(SweepReading& reading, const Json& json, Sweep& sweep);
void readSweepTimes(SweepReading& reading, const Json& json, Sweep& sweep);
void readSweepScenes(SweepReading& reading, const Json& json, Sweep& sweep);
void readSweepVariants(SweepReading& reading, const Json& json, Sweep& sweep);
void readSweepAxes(SweepReading& reading, const Json& json, SweepVariant& variant);
void readSweepExclusions(SweepReading& reading, const Json& json, SweepVariant& variant);
void readSweepFree(SweepReading& reading, const Json& json, SweepVariant& variant);
std::vector<std::string> readSweepSceneNames(SweepReading& reading, const Json& json);
void readSweepTuning(SweepReading& reading, const Json& json, Sweep& sweep);
// What a scalar says as part of a setting, and as a label; nothing for what is none, or too long.
std::optional<std::string> sweepScalar(const Json& json);
// The axis of that name; notes the near name where there is none.
const SweepAxis* requireSweepAxis(SweepReading& reading, const Json& json, const std::string& wanted,
                                  const SweepVariant& variant);

} // namespace kestrel
