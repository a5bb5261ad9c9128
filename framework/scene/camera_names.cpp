#include "scene/camera_names.h"
#include "core/error.h"
#include "scene/geometry.h"
#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <optional>
#include <set>

namespace kestrel {
namespace {

std::optional<size_t> wholeNumber(const std::string& text) {
    size_t number = 0;
    const char* end = text.data() + text.size();
    const auto [rest, failure] = std::from_chars(text.data(), end, number);
    return failure == std::errc() && rest == end ? std::optional(number) : std::nullopt;
}

// "'a', 'b' and 3 more": enough to choose from, and one line.
std::string listOf(const std::vector<std::string>& names) {
    constexpr size_t most = 12;
    std::string list;
    for (size_t i = 0; i < std::min(names.size(), most); ++i)
        list += fmt::format("{}'{}'", i == 0 ? "" : i + 1 == names.size() ? " and " : ", ", names[i]);
    return names.size() > most ? fmt::format("{} and {} more", list, names.size() - most) : list;
}

} // namespace

void nameCamerasApart(std::vector<Camera>& cameras) {
    std::set<std::string> taken;
    for (const Camera& camera : cameras) taken.insert(camera.name);
    std::set<std::string> given;
    for (size_t i = 0; i < cameras.size(); ++i) {
        std::string& name = cameras[i].name;
        if (!name.empty() && given.insert(name).second) continue;
        const std::string base = name.empty() ? fmt::format("camera {}", i) : name;
        name = base;
        for (int n = 2; taken.contains(name); ++n) name = fmt::format("{} ({})", base, n);
        taken.insert(name);
        given.insert(name);
    }
}

int cameraIndex(const Scene& scene, const std::string& name) {
    std::vector<std::string> names;
    if (name.empty() && !scene.cameras.empty()) return scene.camera;
    for (size_t i = 0; i < scene.cameras.size(); ++i) {
        if (scene.cameras[i].name == name) return static_cast<int>(i);
        names.push_back(scene.cameras[i].name);
    }
    const std::optional<size_t> index = wholeNumber(name);
    if (index && *index < names.size()) return static_cast<int>(*index);
    throw InputError(Location{scene.source},
                     fmt::format("the scene has no camera '{}'{}; it has {}{}", name, didYouMean(name, names),
                                 listOf(names), index ? ", counted from 0" : ""));
}

} // namespace kestrel
