#include "scene/builtin.h"
#include "core/error.h"
#include "scene/builtin/blended.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/split.h"
#include "scene/builtin/stress_scenes.h"
#include "scene/builtin/surround.h"
#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <string_view>

namespace kestrel {
namespace {

constexpr std::string_view prefix = "builtin:";

struct Entry {
    std::string_view name, description;
    Scene (*make)(builtin::Detail);
};

constexpr Entry entries[] = {
    {"cornell", "The Cornell box: red and green walls, two boxes, a rectangle area light",
     builtin::makeCornell},
    {"blob", "A displaced sphere of 70k triangles in the shape of a hare, on a round floor",
     builtin::makeBlob},
    {"tower", "A spiral staircase of 79k triangles: many overlapping occluders", builtin::makeTower},
    {"hall", "A colonnade with arches, hangings and a vault, over 200k triangles; spot light, camera path",
     builtin::makeHall},
    {"grove", "Trees and grass of alpha-masked cards, over 100k triangles, in the sun", builtin::makeGrove},
    {"morph", "A creature in a room, deformed by animated morph targets; area light", builtin::makeMorph},
    {"skinned", "A four-legged creature that walks on the spot: an animated skin", builtin::makeSkinned},
    {"pool", "A tiled bath with water, glass and mirrors; area light and point light", builtin::makePool},
    {"lattice", "Sixty layers of bars: up to about 100 surfaces along a view ray", builtin::makeLattice},
};

std::vector<std::string> names() {
    std::vector<std::string> all;
    for (const Entry& entry : entries) all.emplace_back(entry.name);
    return all;
}

// What stands behind '?': "detail=0.1&split=4&extent=16&blended=0.3".
struct Query {
    double detail = 1;
    int split = 1;
    double extent = 1;
    double blended = 0; // 0: materials stay as they are
};

// The whole of `text` as a number within the range.
template<class Number>
Number parseNumber(const std::string& source, std::string_view key, std::string_view text, Number minimum,
                   Number maximum, std::string_view kind) {
    Number value{};
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc() || end != text.data() + text.size() ||
        !(value >= minimum && value <= maximum)) {
        throw InputError(fmt::format("{}: {} is '{}'; it must be a {} from {} to {}", source, key, text, kind,
                                     minimum, maximum));
    }
    return value;
}

// "stress_layers?count=100".
Scene stressScene(const std::string& source, std::string_view name, std::string_view query) {
    std::vector<std::string> names;
    for (const builtin::StressScene& entry : builtin::stressScenes()) {
        names.push_back("stress_" + std::string(entry.name));
        if (names.back() != name) continue;
        int count = entry.count;
        if (query.starts_with("count=") && entry.most > 0)
            count = parseNumber(source, "count", query.substr(6), 1, entry.most, "whole number");
        else if (!query.empty())
            throw InputError(fmt::format(
                "{}: {}", source, entry.most > 0 ? "it has one property, count" : "it has no properties"));
        Scene scene = entry.make(count);
        scene.name = std::string(prefix) + std::string(name);
        scene.source = source;
        return scene;
    }
    throw InputError(fmt::format("there is no built-in scene '{}'{}", name, didYouMean(name, names)));
}

Query parseQuery(const std::string& source, std::string_view text) {
    Query query;
    std::vector<std::string> seen;
    for (size_t begin = 0; begin <= text.size();) {
        const size_t end = std::min(text.find('&', begin), text.size());
        const std::string_view part = text.substr(begin, end - begin);
        begin = end + 1;
        const size_t equals = std::min(part.find('='), part.size());
        const std::string key(part.substr(0, equals));
        const std::string_view value = part.substr(std::min(equals + 1, part.size()));
        if (std::ranges::find(seen, key) != seen.end())
            throw InputError(fmt::format("{}: the property '{}' is there twice", source, key));
        if (key == "detail") {
            query.detail = parseNumber(source, key, value, 0.01, 4.0, "number");
        } else if (key == "split") {
            query.split = parseNumber(source, key, value, 1, 64, "whole number");
        } else if (key == "extent") {
            query.extent = parseNumber(source, key, value, 1.0, 1000.0, "number");
        } else if (key == "blended") {
            query.blended = parseNumber(source, key, value, 0.01, 1.0, "number");
        } else {
            throw InputError(fmt::format(
                "{}: unknown property '{}' of a built-in scene{}; there are: detail, split, extent, blended",
                source, key, didYouMean(key, {"detail", "split", "extent", "blended"})));
        }
        seen.push_back(key);
    }
    return query;
}

} // namespace

bool isBuiltin(const std::string& source) { return source.starts_with(prefix); }

std::vector<BuiltinInfo> builtinInfos() {
    std::vector<BuiltinInfo> all;
    for (const Entry& entry : entries)
        all.push_back({std::string(entry.name), std::string(entry.description)});
    return all;
}

std::vector<std::string> builtinNames() { return names(); }

Scene builtinScene(const std::string& source) {
    if (!isBuiltin(source)) throw InputError(fmt::format("'{}' is not a built-in scene", source));
    const std::string_view rest = std::string_view(source).substr(prefix.size());
    const size_t question = rest.find('?');
    const std::string name(rest.substr(0, question));
    if (name.starts_with("stress_"))
        return stressScene(source, name,
                           question == std::string_view::npos ? std::string_view()
                                                              : rest.substr(question + 1));
    const Query query =
        question == std::string_view::npos ? Query{} : parseQuery(source, rest.substr(question + 1));
    for (const Entry& entry : entries) {
        if (entry.name != name) continue;
        Scene scene = entry.make(builtin::Detail(query.detail));
        try {
            builtin::splitTriangles(scene, query.split);
        } catch (const InputError& error) {
            throw InputError(fmt::format("{}: {}", source, error.what()));
        }
        builtin::surround(scene, query.extent);
        if (query.blended > 0) builtin::blend(scene, static_cast<float>(query.blended));
        scene.name = std::string(prefix) + name;
        scene.source = source;
        return scene;
    }
    throw InputError(fmt::format("there is no built-in scene '{}'{}", name, didYouMean(name, names())));
}

} // namespace kestrel
