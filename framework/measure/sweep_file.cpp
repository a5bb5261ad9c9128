// Reading a sweep file: values, scenes, variants and what must hold between them. The keys stand in
// sweep_keys.cpp.
#include "measure/sweep_file.h"
#include "core/files.h"
#include "measure/sweep_keys.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel {
namespace {

// Series may name axes: "ROMA {roma.angular}".
void checkPlaceholders(SweepReading& reading, const Json& series, const SweepVariant& variant) {
    for (size_t open = series.text.find('{'); open != std::string::npos;
         open = series.text.find('{', open + 1)) {
        const size_t close = series.text.find('}', open);
        if (close == std::string::npos) break;
        requireSweepAxis(reading, series, series.text.substr(open + 1, close - open - 1), variant);
    }
}

// `output` or `hits`, and what these are held against.
void checkOutput(SweepReading& reading, const Json& json, SweepVariant& variant) {
    const Json* output = json.find("output");
    const Json* hits = json.find("hits");
    variant.ray = hits != nullptr;
    if ((output == nullptr) == (hits == nullptr))
        reading.note(json.where, fmt::format("the variant '{}' must have either 'output' (a picture) or "
                                             "'hits' (of RayQuery)",
                                             variant.name));
    else if (variant.ray && !reading.sweep.rays)
        reading.note(hits->where,
                     "a variant with 'hits' needs the sweep's 'rays': what they are held against");
    else if (!variant.ray && !reading.sweep.reference)
        reading.note(output->where, "a variant with 'output' needs the sweep's 'reference'");
}

void readVariant(SweepReading& reading, const Json& json) {
    SweepVariant variant;
    variant.where = json.where;
    sweepVariantKeys().read(reading, json, "a variant", variant);
    if (std::ranges::any_of(reading.sweep.variants,
                            [&](const auto& other) { return other.name == variant.name; }))
        reading.note(json.where, fmt::format("the variant '{}' is there twice", variant.name));
    checkOutput(reading, json, variant);
    if (const Json* series = json.find("series"))
        checkPlaceholders(reading, *series, variant);
    else
        variant.series = variant.name;
    if (const Json* along = json.find("along"))
        requireSweepAxis(reading, *along, variant.along, variant);
    else if (!variant.axes.empty())
        variant.along = variant.axes.front().name;
    if (const Json* free = json.find("tune"); free != nullptr && !reading.sweep.tuning)
        reading.note(free->where,
                     "a variant with 'tune' needs the sweep's 'tune': which scenes it is tuned on");
    if (const Json* exact = json.find("exact"); exact != nullptr && variant.ray)
        reading.note(exact->where, "only the error of a picture is taken apart, not that of 'hits'");
    if (const Json* frames = json.find("frames")) {
        if (variant.ray)
            reading.note(frames->where,
                         "how many frames a variant with 'hits' runs stands in 'rays': all trace the same");
        else if (reading.sweep.moving)
            reading.note(frames->where,
                         "where scenes move, all variants run as many frames as the reference's time needs");
    }
    reading.sweep.variants.push_back(std::move(variant));
}

} // namespace

std::string cameraOf(const SweepScene& scene) {
    const SceneSetup& setup = scene.setup;
    if (!setup.camera) return setup.cameraName;
    return setup.camera->name.empty() ? cameraText(*setup.camera) : setup.camera->name;
}

std::string readSweepText(SweepReading& reading, const Json& json) {
    if (json.text.size() > maxGraphText)
        reading.note(json.where,
                     fmt::format("a text of {} bytes; at most {} are read", json.text.size(), maxGraphText));
    return json.text;
}

std::string readSweepName(SweepReading& reading, const Json& json, const std::string& what) {
    const bool printable = std::ranges::none_of(
        json.text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
    if (!json.text.empty() && json.text.size() <= maxSweepName && printable) return json.text;
    reading.note(json.where,
                 fmt::format("the {} must be a printable text of 1 to {} bytes", what, maxSweepName));
    return {};
}

std::optional<int> readSweepWhole(SweepReading& reading, const Json& json, const std::string& key,
                                  int minimum, int maximum) {
    if (json.isWhole() && json.integer >= minimum && json.integer <= maximum)
        return static_cast<int>(json.integer);
    reading.note(json.where, fmt::format("'{}' must be a whole number from {} to {}", key, minimum, maximum));
    return std::nullopt;
}

std::optional<double> readSweepNumber(SweepReading& reading, const Json& json, const std::string& key,
                                      double minimum, double maximum) {
    if (json.isNumber() && json.number >= minimum && json.number <= maximum) return json.number;
    reading.note(json.where, fmt::format("'{}' must be a number from {} to {}", key, minimum, maximum));
    return std::nullopt;
}

std::optional<PortRef> readSweepPort(SweepReading& reading, const Json& json, const std::string& key) {
    auto port = parsePortRef(json.text);
    if (!port) reading.note(json.where, fmt::format("'{}' must be \"pass.port\", not '{}'", key, json.text));
    return port;
}

std::vector<SweepSetting> readSweepSettings(SweepReading& reading, const Json& json) {
    std::vector<SweepSetting> settings;
    if (!reading.allows(json.where, json.items.size(), maxSweepSettings, "settings")) return settings;
    for (const Json& item : json.items) {
        if (item.kind == Json::Kind::String && item.text.size() > maxSweepSetting)
            reading.note(item.where, fmt::format("a setting of {} bytes; at most {} are read",
                                                 item.text.size(), maxSweepSetting));
        else if (item.kind == Json::Kind::String)
            settings.push_back({item.text, item.where});
        else
            reading.note(item.where, fmt::format("a setting must be a string as '--set' takes it, not {}",
                                                 item.kindName()));
    }
    return settings;
}

void readSweepSize(SweepReading& reading, const Json& size, Sweep& sweep) {
    const auto side = [](const Json& json) {
        return json.isWhole() && json.integer >= 1 && json.integer <= maxSweepSide;
    };
    if (size.kind == Json::Kind::Array && size.items.size() == 2 && side(size.items[0]) &&
        side(size.items[1]))
        sweep.size = {static_cast<std::uint32_t>(size.items[0].integer),
                      static_cast<std::uint32_t>(size.items[1].integer), 1};
    else
        reading.note(size.where,
                     fmt::format("'size' must be [width, height] with 1 to {} each", maxSweepSide));
}

void readSweepTimes(SweepReading& reading, const Json& times, Sweep& sweep) {
    if (!reading.allows(times.where, times.members.size(), maxSweepTimes, "times")) return;
    for (const Json::Member& member : times.members) {
        SweepTime time{member.key, {}};
        if (member.value.kind != Json::Kind::Array || member.value.items.empty())
            reading.note(member.value.where, fmt::format("the time '{}' must be an array of groups and "
                                                         "passes, as [\"generation\", \"-bom\"]",
                                                         member.key));
        for (const Json& item : member.value.items) {
            if (item.kind != Json::Kind::String || item.text.empty() || item.text == "-") {
                reading.note(item.where, "a part of a time must be the name of a group or a pass, with '-' "
                                         "before it where it is subtracted");
                continue;
            }
            const bool minus = item.text.front() == '-';
            time.terms.push_back({item.text.substr(minus ? 1 : 0), minus ? -1.0 : 1.0});
        }
        if (member.key == "total" || member.key == "frame")
            reading.note(member.where, fmt::format("the time '{}' is there already", member.key));
        sweep.times.push_back(std::move(time));
    }
}

void readSweepScenes(SweepReading& reading, const Json& scenes, Sweep& sweep) {
    if (scenes.items.empty()) reading.note(scenes.where, "'scenes' is empty: there is nothing to measure on");
    if (!reading.allows(scenes.where, scenes.items.size(), maxSweepScenes, "scenes")) return;
    for (const Json& item : scenes.items) {
        SweepScene scene;
        scene.where = item.where;
        if (item.kind == Json::Kind::String) {
            scene.source = item.text;
        } else {
            sweepSceneKeys().read(reading, item, "a scene", scene);
            if (item.kind != Json::Kind::Object) continue;
        }
        if (scene.source.empty())
            reading.note(item.where, "the scene must be 'builtin:NAME' or name a .gltf or .glb file");
        if (scene.name.empty()) {
            const bool builtin = scene.source.starts_with("builtin:");
            scene.name =
                builtin ? scene.source.substr(8) : std::filesystem::path(scene.source).filename().string();
            const std::string& camera =
                scene.setup.camera ? scene.setup.camera->name : scene.setup.cameraName;
            if (!camera.empty()) scene.name += ", " + camera;
        }
        if (std::ranges::any_of(sweep.scenes, [&](const auto& other) { return other.name == scene.name; }))
            reading.note(item.where,
                         fmt::format("the scene '{}' is there twice: give one another 'name'", scene.name));
        scene.slug = sweepSlug(scene.name, reading.sceneSlugs);
        sweep.scenes.push_back(std::move(scene));
    }
}

void readSweepVariants(SweepReading& reading, const Json& variants, Sweep&) {
    if (variants.items.empty())
        reading.note(variants.where, "'variants' is empty: there is nothing to measure");
    if (!reading.allows(variants.where, variants.items.size(), maxSweepPoints, "variants")) return;
    for (const Json& item : variants.items) {
        if (item.kind == Json::Kind::Object)
            readVariant(reading, item);
        else
            reading.note(item.where, fmt::format("a variant must be an object, not {}", item.kindName()));
    }
}

Sweep parseSweep(std::string_view text, const std::string& file) {
    std::vector<Problem> problems;
    Sweep sweep;
    sweep.file = file;
    sweep.name = sweep.title = sweep.file.stem().string();
    SweepReading reading{problems, sweep, {}};
    try {
        sweepKeys().read(reading, Json::parse(text, file), "the sweep", sweep);
    } catch (const InputError& tooMany) {
        problems = tooMany.problems();
    }
    std::ranges::stable_sort(problems, {}, [](const Problem& problem) {
        return std::pair(problem.where.line, problem.where.column);
    });
    if (!problems.empty()) throw InputError(std::move(problems));
    return sweep;
}

Sweep loadSweep(const std::filesystem::path& file) {
    Sweep sweep = parseSweep(readGivenText(file), file.string());
    // What comes through a pipe lies nowhere: graphs and scenes are named from the working folder.
    if (isStream(file)) sweep.file = file.filename();
    return sweep;
}

} // namespace kestrel
