// Reading what `kestrel tune` may set, and on which scenes it looks.
#include "measure/sweep_keys.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel {
namespace {

void readRange(SweepReading& reading, const Json& json, SweepFree& free) {
    const bool numbers = json.items.size() == 2 && json.items[0].isNumber() && json.items[1].isNumber();
    if (!numbers || json.items[0].number >= json.items[1].number) {
        reading.note(json.where,
                     fmt::format("the range of '{}' must be [low, high] with low < high", free.name));
        return;
    }
    free.low = json.items[0].number;
    free.high = json.items[1].number;
    if (free.logarithmic && free.low <= 0)
        reading.note(json.where,
                     fmt::format("the range of '{}' is logarithmic: it must begin above 0", free.name));
}

void readChoices(SweepReading& reading, const Json& json, SweepFree& free) {
    if (json.items.empty()) reading.note(json.where, fmt::format("'{}' has no choices", free.name));
    if (!reading.allows(json.where, json.items.size(), maxSweepSettings, "choices")) return;
    for (const Json& item : json.items) {
        const auto text = sweepScalar(item);
        if (!text)
            reading.note(item.where, fmt::format("a choice of '{}' must be a number, a text of at most {} "
                                                 "bytes, true or false, not {}",
                                                 free.name, maxSweepName, item.kindName()));
        else if (std::ranges::any_of(free.choices, [&](const auto& other) { return other.text == *text; }))
            reading.note(item.where, fmt::format("'{}' has the choice '{}' twice", free.name, *text));
        else
            free.choices.push_back({*text, item.where});
    }
}

// [low, high], any other list, or the long form.
void readFree(SweepReading& reading, const Json& json, SweepFree& free) {
    SweepFreeForm form;
    if (json.kind == Json::Kind::Array) {
        const bool range = json.items.size() == 2 && json.items[0].isNumber() && json.items[1].isNumber();
        (range ? form.range : form.choices) = &json;
    } else if (json.kind == Json::Kind::Object) {
        sweepFreeKeys().read(reading, json, fmt::format("what '{}' may be", free.name), form);
    }
    free.logarithmic = form.logarithmic;
    if ((form.range == nullptr) == (form.choices == nullptr))
        reading.note(json.where,
                     fmt::format("'{}' must be free in a range [low, high], among choices, or by an "
                                 "object with either 'range' or 'choices'",
                                 free.name));
    else if (form.range != nullptr)
        readRange(reading, *form.range, free);
    else
        readChoices(reading, *form.choices, free);
}

} // namespace

void readSweepFree(SweepReading& reading, const Json& json, SweepVariant& variant) {
    if (json.members.empty()) reading.note(json.where, "'tune' is empty: nothing is free");
    if (!reading.allows(json.where, json.members.size(), maxSweepFree, "free properties")) return;
    for (const Json::Member& member : json.members) {
        SweepFree free;
        free.name = member.key;
        free.where = member.where;
        if (!parsePortRef(free.name))
            reading.note(member.where,
                         fmt::format("what is free must be \"pass.property\", not '{}'", member.key));
        if (std::ranges::any_of(variant.axes, [&](const auto& axis) { return axis.name == free.name; }))
            reading.note(member.where, fmt::format("'{}' is an axis already: it cannot be free", free.name));
        readFree(reading, member.value, free);
        variant.free.push_back(std::move(free));
    }
}

std::vector<std::string> readSweepSceneNames(SweepReading& reading, const Json& json) {
    std::vector<std::string> names, known;
    for (const SweepScene& scene : reading.sweep.scenes) known.push_back(scene.name);
    if (!reading.allows(json.where, json.items.size(), maxSweepScenes, "names of scenes")) return names;
    for (const Json& item : json.items) {
        if (item.kind != Json::Kind::String)
            reading.note(item.where, fmt::format("a scene is named by a text, not {}", item.kindName()));
        else if (std::ranges::find(known, item.text) == known.end())
            reading.note(item.where, fmt::format("the sweep has no scene of the name '{}'{}", item.text,
                                                 didYouMean(item.text, known)));
        else if (std::ranges::find(names, item.text) != names.end())
            reading.note(item.where, fmt::format("the scene '{}' is named twice", item.text));
        else
            names.push_back(item.text);
    }
    return names;
}

void readSweepTuning(SweepReading& reading, const Json& json, Sweep& sweep) {
    SweepTuning& tuning = sweep.tuning.emplace();
    sweepTuningKeys().read(reading, json, "'tune'", tuning);
    const Json* train = json.find("train");
    if (train != nullptr && train->kind == Json::Kind::Array && train->items.empty())
        reading.note(train->where, "'train' is empty: there is nothing to tune on");
    const auto trained = [&](const std::string& name) {
        return std::ranges::find(tuning.train, name) != tuning.train.end();
    };
    const Json* holdOut = json.find("hold_out");
    if (holdOut == nullptr) {
        for (const SweepScene& scene : sweep.scenes)
            if (!trained(scene.name)) tuning.holdOut.push_back(scene.name);
        return;
    }
    for (const Json& item : holdOut->items)
        if (trained(item.text))
            reading.note(item.where,
                         fmt::format("the scene '{}' is trained on: it cannot be held out", item.text));
}

} // namespace kestrel
