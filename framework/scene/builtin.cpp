#include "scene/builtin.h"
#include "core/error.h"
#include "scene/builtin/scenes.h"
#include <charconv>
#include <fmt/format.h>
#include <string_view>

namespace kestrel {
namespace {

constexpr std::string_view prefix = "builtin:";

struct Entry {
    std::string_view name, sentence;
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

// The value of detail in "detail=0.1".
double parseDetail(const std::string& source, std::string_view query) {
    const size_t equals = query.find('=');
    const std::string key(query.substr(0, equals));
    if (key != "detail") {
        throw InputError(fmt::format("{}: unknown property '{}' of a built-in scene{}; there is: detail",
                                     source, key, didYouMean(key, {"detail"})));
    }
    const std::string_view text = equals == std::string_view::npos ? "" : query.substr(equals + 1);
    double value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc() || end != text.data() + text.size() || !(value >= 0.01 && value <= 4)) {
        throw InputError(fmt::format("{}: detail is '{}'; it must be a number from 0.01 to 4", source, text));
    }
    return value;
}

} // namespace

bool isBuiltin(const std::string& source) { return source.starts_with(prefix); }

std::vector<BuiltinInfo> builtinInfos() {
    std::vector<BuiltinInfo> all;
    for (const Entry& entry : entries) all.push_back({std::string(entry.name), std::string(entry.sentence)});
    return all;
}

std::vector<std::string> builtinNames() { return names(); }

Scene builtinScene(const std::string& source) {
    if (!isBuiltin(source)) throw InputError(fmt::format("'{}' is not a built-in scene", source));
    const std::string_view rest = std::string_view(source).substr(prefix.size());
    const size_t question = rest.find('?');
    const std::string name(rest.substr(0, question));
    const double detail =
        question == std::string_view::npos ? 1.0 : parseDetail(source, rest.substr(question + 1));
    for (const Entry& entry : entries) {
        if (entry.name != name) continue;
        Scene scene = entry.make(builtin::Detail(detail));
        scene.name = std::string(prefix) + name;
        scene.source = source;
        return scene;
    }
    throw InputError(fmt::format("there is no built-in scene '{}'{}", name, didYouMean(name, names())));
}

} // namespace kestrel
