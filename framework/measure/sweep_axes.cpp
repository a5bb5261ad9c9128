// Reading the axes of a variant, and what of them is excluded.
#include "graph/value_text.h"
#include "measure/sweep_keys.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kestrel {
namespace {

// A scalar goes into the templates; an object says its own settings.
void readAxisValue(SweepReading& reading, const Json& json, const std::vector<std::string>& templates,
                   SweepAxis& axis) {
    SweepAxisValue value;
    if (const auto text = sweepScalar(json)) {
        value.label = *text;
        for (const std::string& form : templates) {
            std::string setting = form;
            if (const size_t at = setting.find("{}"); at != std::string::npos) setting.replace(at, 2, *text);
            value.settings.push_back({setting, json.where});
        }
    } else if (json.kind == Json::Kind::Object) {
        sweepAxisValueKeys().read(reading, json, fmt::format("a value of the axis '{}'", axis.name), value);
    } else {
        reading.note(
            json.where,
            json.kind == Json::Kind::String
                ? fmt::format("a value of {} bytes; at most {} are read", json.text.size(), maxSweepName)
                : fmt::format("a value of the axis '{}' must be a number, a text, true or false, or an "
                              "object with 'label' and 'set', not {}",
                              axis.name, json.kindName()));
        return;
    }
    if (std::ranges::any_of(axis.values, [&](const auto& other) { return other.label == value.label; }))
        reading.note(json.where,
                     fmt::format("the axis '{}' has the value '{}' twice", axis.name, value.label));
    axis.values.push_back(std::move(value));
}

void readExclusion(SweepReading& reading, const Json& json, SweepVariant& variant) {
    if (json.kind != Json::Kind::Object || json.members.empty()) {
        reading.note(json.where, "an exclusion must be an object of axis and value");
        return;
    }
    std::map<std::string, std::string> exclusion;
    for (const Json::Member& member : json.members) {
        const SweepAxis* axis = requireSweepAxis(reading, member.value, member.key, variant);
        const auto label = sweepScalar(member.value);
        if (!label) reading.note(member.value.where, "an axis is excluded at one of its values");
        if (axis == nullptr || !label) continue;
        std::vector<std::string> labels;
        for (const SweepAxisValue& value : axis->values) labels.push_back(value.label);
        if (std::ranges::find(labels, *label) == labels.end())
            reading.note(member.value.where, fmt::format("the axis '{}' has no value '{}' (it has {})",
                                                         axis->name, *label, fmt::join(labels, ", ")));
        exclusion[member.key] = *label;
    }
    variant.exclude.push_back(std::move(exclusion));
}

} // namespace

std::optional<std::string> sweepScalar(const Json& json) {
    switch (json.kind) {
    case Json::Kind::Bool:
        return json.boolean ? "true" : "false";
    case Json::Kind::Int:
        return std::to_string(json.integer);
    case Json::Kind::Float:
        return numberText(json.number);
    case Json::Kind::String:
        return json.text.size() <= maxSweepName ? std::optional(json.text) : std::nullopt;
    default:
        return std::nullopt;
    }
}

const SweepAxis* requireSweepAxis(SweepReading& reading, const Json& json, const std::string& wanted,
                                  const SweepVariant& variant) {
    std::vector<std::string> names;
    for (const SweepAxis& axis : variant.axes) {
        if (axis.name == wanted) return &axis;
        names.push_back(axis.name);
    }
    reading.note(json.where, fmt::format("the variant '{}' has no axis '{}'{}", variant.name, wanted,
                                         didYouMean(wanted, names)));
    return nullptr;
}

void readSweepAxes(SweepReading& reading, const Json& json, SweepVariant& variant) {
    if (!reading.allows(json.where, json.members.size(), maxSweepAxes, "axes")) return;
    for (const Json::Member& member : json.members) {
        SweepAxis axis;
        axis.name = member.key;
        if (!reading.allows(member.where, axis.name.size(), maxSweepName, "bytes in the name of an axis"))
            continue;
        std::vector<std::string> templates;
        const Json* values = &member.value;
        if (member.value.kind == Json::Kind::Array) {
            templates = {axis.name + "={}"};
        } else {
            SweepAxisForm form;
            sweepAxisKeys().read(reading, member.value, fmt::format("the axis '{}'", axis.name), form);
            if (member.value.kind != Json::Kind::Object) continue;
            for (const SweepSetting& setting : form.templates) {
                if (setting.text.find("{}") == std::string::npos)
                    reading.note(
                        setting.where,
                        fmt::format("the setting '{}' of the axis '{}' must hold {{}}, for the value",
                                    setting.text, axis.name));
                templates.push_back(setting.text);
            }
            values = form.values;
        }
        if (values != nullptr &&
            reading.allows(values->where, values->items.size(), maxSweepPoints, "values of an axis"))
            for (const Json& item : values->items) readAxisValue(reading, item, templates, axis);
        if (axis.values.empty())
            reading.note(member.value.where, fmt::format("the axis '{}' has no values", axis.name));
        variant.axes.push_back(std::move(axis));
    }
}

void readSweepExclusions(SweepReading& reading, const Json& json, SweepVariant& variant) {
    if (!reading.allows(json.where, json.items.size(), maxSweepExclusions, "exclusions")) return;
    for (const Json& item : json.items) readExclusion(reading, item, variant);
}

} // namespace kestrel
