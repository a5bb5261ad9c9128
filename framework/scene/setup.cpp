// Setups as text, and setting up a scene.
#include "scene/setup.h"
#include "core/files.h"
#include "scene/builtin.h"
#include "scene/geometry.h"
#include "scene/setup_keys.h"
#include <charconv>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace kestrel {
namespace {

constexpr double defaultFov = 45; // degrees

// ---- text

std::optional<double> numberOf(std::string_view text) {
    double value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
    return value;
}

Json numberJson(double value, const Location& where) {
    Json json;
    json.kind = Json::Kind::Float;
    json.number = value;
    json.where = where;
    return json;
}

// "0,2,0" where the key takes an array, a number where it takes one, else the text.
template<class Key>
std::optional<Json> valueOfWord(const Key& key, std::string_view text, const Location& where) {
    Json json;
    json.where = where;
    json.text = text;
    json.kind = Json::Kind::String;
    if (key.kind == Json::Kind::Float) {
        const auto number = numberOf(text);
        return number ? std::optional(numberJson(*number, where)) : std::nullopt;
    }
    if (key.kind != Json::Kind::Array) return json;
    json.kind = Json::Kind::Array;
    while (true) {
        const size_t comma = text.find(',');
        const auto number = numberOf(text.substr(0, comma));
        if (!number) return {};
        json.items.push_back(numberJson(*number, where));
        if (comma == std::string_view::npos) return json;
        text.remove_prefix(comma + 1);
    }
}

// "key=value key=value"; a first word without '=' is the value of `first`, where that is not empty.
template<class T>
Json wordsJson(const SetupKeys<T>& keys, std::string_view text, const std::string& first,
               const Location& where, std::vector<Problem>& problems) {
    Json object;
    object.kind = Json::Kind::Object;
    object.where = where;
    for (bool begin = true; !text.empty(); begin = false) {
        const size_t space = text.find(' ');
        const std::string word(text.substr(0, space));
        text.remove_prefix(space == std::string_view::npos ? text.size() : space + 1);
        if (word.empty()) continue;
        const size_t equals = word.find('=');
        const bool bare = equals == std::string::npos;
        if (bare && (!begin || first.empty())) {
            problems.push_back({where, fmt::format("'{}' is not of the form key=value", word)});
            continue;
        }
        const std::string name = bare ? first : word.substr(0, equals);
        const std::string value = bare ? word : word.substr(equals + 1);
        const auto* key = keys.find(name);
        if (key == nullptr)
            problems.push_back(
                {where, fmt::format("there is no key '{}'{}", name, didYouMean(name, keys.names()))});
        else if (object.find(name) != nullptr)
            problems.push_back({where, fmt::format("'{}' is there twice", name)});
        else if (auto json = valueOfWord(*key, value, where))
            object.members.push_back({name, where, std::move(*json)});
        else
            problems.push_back(
                {where, fmt::format("'{}' must be {}, not '{}'", name,
                                    key->kind == Json::Kind::Float ? "a number" : "numbers with ',' between",
                                    value)});
    }
    return object;
}

template<class T>
T parsed(const SetupKeys<T>& keys, const std::string& text, const std::string& first, const std::string& what,
         const std::string& name) {
    std::vector<Problem> problems;
    const size_t begin = text.find_first_not_of(' ');
    Json json;
    if (begin != std::string::npos && text[begin] == '{')
        json = Json::parse(text, what);
    else
        json = wordsJson(keys, text, first, Location{what}, problems);
    T into;
    if (problems.empty()) keys.read(problems, json, name, into);
    if (!problems.empty()) throw InputError(std::move(problems));
    return into;
}

template<class T>
std::string helpText(const SetupKeys<T>& keys) {
    std::string text;
    for (const auto& key : keys.keys()) text += fmt::format("  {:<14} {}\n", key.name, key.description);
    return text;
}

// ---- setting up

// A right-handed frame at `position` that looks along -z.
glm::dmat4 lookFrame(const glm::dvec3& position, const glm::dvec3& direction,
                     const std::optional<glm::dvec3>& up) {
    const glm::dvec3 z = -glm::normalize(direction);
    const glm::dvec3 upward =
        up.value_or(std::abs(z.y) > 1 - 1e-9 ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0));
    glm::dvec3 x = glm::cross(upward, z);
    if (!(glm::dot(x, x) > 0))
        x = glm::cross(std::abs(z.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0), z);
    x = glm::normalize(x);
    return {glm::dvec4(x, 0), glm::dvec4(glm::cross(z, x), 0), glm::dvec4(z, 0), glm::dvec4(position, 1)};
}

class Setter {
public:
    Setter(Scene& scene, const SceneSetup& setup, const std::filesystem::path& folder)
        : scene_(scene)
        , setup_(setup)
        , folder_(folder) {}

    // What must be there before the scene is finished: what moves decides its bounds.
    void before() {
        chooseAnimation();
        if (setup_.camera && setup_.cameraName.empty()) addCamera(*setup_.camera);
        for (const AddedLight& light : setup_.lights) addLight(light);
        if (!problems_.empty()) throw InputError(std::move(problems_));
    }
    // And after: cameras have their names, the timeline its length.
    void after() {
        if (added_ >= 0)
            scene_.camera = added_;
        else if (!setup_.cameraName.empty())
            scene_.camera = cameraIndex(scene_, setup_.cameraName);
        scene_.startTime = setup_.time.value_or(0);
        scene_.frameRate = setup_.fps.value_or(60);
        if (scene_.startTime > scene_.duration())
            scene_.warnings.push_back(
                fmt::format("the time of the first frame, {} s, lies after the end of the scene's "
                            "timeline, {} s: what moves stands as at its end",
                            scene_.startTime, scene_.duration()));
    }

private:
    void note(const std::string& message, const Location& where = {}) {
        problems_.push_back({where.file.empty() ? Location{scene_.source} : where, message});
    }

    void chooseAnimation() {
        const std::string& wanted = setup_.animation;
        std::vector<std::string> names;
        for (const Animation& animation : scene_.animations) names.push_back(animation.name);
        auto found = std::ranges::find(names, wanted);
        const auto number = numberOf(wanted);
        if (wanted.empty()) return;
        if (found == names.end() && number && *number >= 0 && *number < static_cast<double>(names.size()) &&
            *number == std::floor(*number))
            found = names.begin() + static_cast<std::ptrdiff_t>(*number);
        if (found != names.end()) {
            Animation chosen = std::move(scene_.animations[static_cast<size_t>(found - names.begin())]);
            scene_.animations = {std::move(chosen)};
        } else if (wanted == "none") {
            scene_.animations.clear();
        } else if (wanted != "all") {
            std::string there;
            for (size_t i = 0; i < names.size(); ++i)
                there += fmt::format("{}{} '{}'", i == 0 ? "" : ", ", i, names[i]);
            note(fmt::format("the scene has no animation '{}'{}; it has {}", wanted,
                             didYouMean(wanted, names), there.empty() ? "none" : there));
        }
    }

    // The index of a node by its name; -1 for the world, also where there is none of that name.
    int nodeOf(const std::string& name, const Location& where = {}) {
        if (name.empty()) return -1;
        std::vector<std::string> names;
        for (size_t i = 0; i < scene_.nodes.size(); ++i) {
            if (scene_.nodes[i].name == name) return static_cast<int>(i);
            names.push_back(scene_.nodes[i].name);
        }
        note(fmt::format("the scene has no node '{}'{}", name, didYouMean(name, names)), where);
        return -1;
    }

    // What the file of a path says, where `camera` says nothing.
    AddedCamera withPath(const AddedCamera& camera) {
        if (camera.path.empty()) return camera;
        const std::filesystem::path file = folder_ / camera.path;
        AddedCamera whole;
        try {
            const Json json = Json::parse(readGivenText(file), file.string());
            JsonFields fields(json, "the camera", problems_);
            if (json.kind != Json::Kind::Object) return camera;
            const Json* version = fields.required("kestrel_camera", Json::Kind::Int);
            if (version != nullptr && version->integer != 1)
                note(fmt::format("'kestrel_camera' (the version of the format) must be 1, not {}",
                                 version->integer),
                     version->where);
            addedCameraKeys().readFields(problems_, fields, json, whole);
            if (const Json* path = json.find("path"))
                note("'path' cannot stand in the file of a path", path->where);
            fields.refuseOthers();
        } catch (const InputError& error) {
            problems_.insert(problems_.end(), error.problems().begin(), error.problems().end());
        }
        addedCameraKeys().join(whole, camera);
        return whole;
    }

    void addCamera(const AddedCamera& given) {
        const size_t known = problems_.size();
        const AddedCamera added = withPath(given);
        if (problems_.size() != known) return;
        Camera camera;
        camera.name = added.name.empty() ? "added" : added.name;
        camera.smooth = added.interpolation == "smooth";
        const int parent = nodeOf(added.node);
        std::vector<AddedCameraKey> keys = added.keys;
        if (keys.empty()) keys.emplace_back();
        double nearest = INFINITY;
        for (const AddedCameraKey& key : keys) {
            auto eye = key.eye ? key.eye : added.eye;
            auto target = key.target ? key.target : added.target;
            if (!added.node.empty() && !eye) eye = glm::dvec3(0);
            if (!added.node.empty() && !target) target = *eye + glm::dvec3(0, 0, -1);
            if (!eye || !target) {
                note(fmt::format("the camera '{}' needs '{}'{}", camera.name, eye ? "target" : "eye",
                                 added.keys.empty() ? "" : ", of its own or in each of its keys"));
                return;
            }
            const glm::dvec3 view = *target - *eye;
            const double distance = std::sqrt(glm::dot(view, view));
            if (!(distance > 0)) {
                note(fmt::format("the camera '{}' stands at its target", camera.name));
                return;
            }
            const auto up = key.up ? key.up : added.up;
            if (const glm::dvec3 side = glm::cross(view, up.value_or(glm::dvec3(0)));
                up && !(glm::dot(side, side) > 1e-18 * distance * distance * glm::dot(*up, *up))) {
                note(fmt::format("'up' of the camera '{}' must not lie along the way from eye to target",
                                 camera.name));
                return;
            }
            nearest = std::min(nearest, distance);
            const glm::dmat4 frame = lookFrame(*eye, view, up);
            camera.path.push_back({key.time, *eye, *target, glm::dvec3(frame[1]),
                                   glm::radians(key.fov.value_or(added.fov.value_or(defaultFov)))});
        }
        camera.verticalFov = static_cast<float>(camera.path.front().verticalFov);
        // Depth is reversed and stored as float: the far plane costs no precision.
        camera.nearPlane = static_cast<float>(added.nearPlane.value_or(0.01 * nearest));
        camera.farPlane = static_cast<float>(added.farPlane.value_or(0));
        if (camera.farPlane > 0 && !(camera.farPlane > camera.nearPlane))
            note(fmt::format("'far' of the camera '{}' must be more than 'near', which is {}", camera.name,
                             camera.nearPlane));
        Node node;
        node.name = camera.name;
        node.camera = added_ = static_cast<int>(scene_.cameras.size());
        camera.node = addNode(std::move(node), parent);
        scene_.cameras.push_back(std::move(camera));
    }

    void addLight(const AddedLight& added) {
        Light light;
        light.name = added.name;
        light.kind = added.kind;
        light.colour = glm::vec3(added.color.value_or(glm::dvec3(1)));
        light.intensity = static_cast<float>(added.intensity.value_or(1));
        light.range = static_cast<float>(added.range.value_or(0));
        light.innerCone = static_cast<float>(glm::radians(added.innerCone.value_or(0)));
        light.outerCone = static_cast<float>(glm::radians(added.outerCone.value_or(45)));
        light.halfSize = added.kind == LightKind::Sphere
                             ? glm::vec2(static_cast<float>(added.radius.value_or(0)), 0)
                             : glm::vec2(0.5 * added.width.value_or(0), 0.5 * added.height.value_or(0));
        const int parent = nodeOf(added.node, added.where);
        const glm::dvec3 position = added.position.value_or(glm::dvec3(0));
        glm::dvec3 direction = added.direction.value_or(glm::dvec3(0, 0, -1));
        if (added.target) direction = *added.target - position;
        Node node;
        node.name = added.name;
        node.matrix = lookFrame(position, direction, added.up);
        node.light = static_cast<int>(scene_.lights.size());
        light.node = addNode(std::move(node), parent);
        scene_.lights.push_back(std::move(light));
    }

    int addNode(Node node, int parent) {
        const int index = static_cast<int>(scene_.nodes.size());
        node.parent = parent;
        (parent < 0 ? scene_.roots : scene_.nodes[static_cast<size_t>(parent)].children).push_back(index);
        scene_.nodes.push_back(std::move(node));
        return index;
    }

    Scene& scene_;
    const SceneSetup& setup_;
    const std::filesystem::path& folder_;
    int added_ = -1; // the camera
    std::vector<Problem> problems_;
};

} // namespace

bool describesCamera(const std::string& text) {
    const size_t begin = text.find_first_not_of(' ');
    return begin != std::string::npos && (text[begin] == '{' || text.find('=') != std::string::npos);
}

AddedCamera parseCamera(const std::string& text, const std::string& what) {
    return parsed(addedCameraKeys(), text, "", what, "the camera");
}

AddedLight parseLight(const std::string& text, const std::string& what) {
    return parsed(addedLightKeys(), text, "kind", what, "the light");
}

std::string cameraKeysText() { return helpText(addedCameraKeys()); }
std::string lightKeysText() { return helpText(addedLightKeys()); }

SceneSetup joined(SceneSetup under, const SceneSetup& over) {
    std::vector<AddedLight> lights = under.lights;
    lights.insert(lights.end(), over.lights.begin(), over.lights.end());
    sceneSetupKeys().join(under, over);
    under.lights = std::move(lights);
    return under;
}

SceneSetup located(SceneSetup setup, const std::filesystem::path& folder) {
    if (setup.camera && !setup.camera->path.empty())
        setup.camera->path =
            std::filesystem::absolute(folder / setup.camera->path).lexically_normal().string();
    return setup;
}

std::string cameraText(const AddedCamera& camera) { return addedCameraKeys().write(camera); }
std::string lightText(const AddedLight& light) { return addedLightKeys().write(light); }
std::string setupText(const SceneSetup& setup) { return sceneSetupKeys().write(setup); }

void setUpScene(Scene& scene, const SceneSetup& setup, const std::filesystem::path& folder) {
    Setter setter(scene, setup, folder);
    setter.before();
    finishScene(scene);
    setter.after();
}

} // namespace kestrel
