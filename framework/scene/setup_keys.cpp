// The tables of keys. A key that is added here is read, checked, written, told by --help, and stands in the
// schemas.
#include "scene/setup_keys.h"
#include <array>

namespace kestrel {
namespace {

constexpr double largestLength = 1e9, largestTime = 1e6;
constexpr size_t mostKeys = 10'000, mostLights = 10'000;

// In the order of LightKind.
const std::vector<std::string>& lightKindNames() {
    static const std::vector<std::string> names{"point", "spot", "directional", "rectangle", "sphere"};
    return names;
}

enum LightMask : unsigned { P = 1, S = 2, D = 4, R = 8, B = 16 }; // 1 << LightKind

struct LightKeyUse {
    const char* name;
    unsigned kinds;  // whose key it is
    unsigned needed; // who must have it; of direction and target one
};

constexpr std::array<LightKeyUse, 11> lightKeyUses{{{"position", P | S | R | B, P | S | R | B},
                                                    {"direction", S | D | R, S | D | R},
                                                    {"target", S | R, 0},
                                                    {"up", R, 0},
                                                    {"range", P | S, 0},
                                                    {"inner", S, 0},
                                                    {"outer", S, 0},
                                                    {"width", R, R},
                                                    {"height", R, R},
                                                    {"radius", B, B},
                                                    {"node", P | S | D | R | B, 0}}};

// "point, spot"
std::string kindsText(unsigned kinds) {
    std::vector<std::string> names;
    for (size_t i = 0; i < lightKindNames().size(); ++i)
        if ((kinds >> i & 1) != 0) names.push_back(lightKindNames()[i]);
    return fmt::format("{}", fmt::join(names, ", "));
}

// Whether the keys are those of the light's kind.
void checkLight(std::vector<Problem>& problems, const Json& json, AddedLight& light) {
    light.where = json.where;
    const std::string& kind = lightKindNames()[static_cast<size_t>(light.kind)];
    const unsigned mask = 1u << static_cast<unsigned>(light.kind);
    for (const LightKeyUse& use : lightKeyUses) {
        const Json* value = json.find(use.name);
        if (value != nullptr && (use.kinds & mask) == 0)
            problems.push_back({value->where, fmt::format("a {} light has no '{}': that is of {}", kind,
                                                          use.name, kindsText(use.kinds))});
        const bool aimed = std::string_view(use.name) == "direction" && light.target;
        if (value == nullptr && (use.needed & mask) != 0 && !aimed)
            problems.push_back({json.where, fmt::format("a {} light needs '{}'", kind, use.name)});
    }
    if (light.direction && light.target)
        problems.push_back({json.where, "a light has 'direction' or 'target', not both"});
    if (light.direction && *light.direction == glm::dvec3(0))
        problems.push_back({json.where, "'direction' of a light must not be 0, 0, 0"});
    if (light.position && light.target && *light.position == *light.target)
        problems.push_back({json.where, "'position' and 'target' of a light must not be the same point"});
    if (light.innerCone.value_or(0) > light.outerCone.value_or(45))
        problems.push_back({json.where, "'inner' of a light must not be more than 'outer' (45 by default)"});
}

void checkCameraKeys(std::vector<Problem>& problems, const Json& json, AddedCamera& camera) {
    for (size_t i = 1; i < camera.keys.size(); ++i)
        if (!(camera.keys[i].time > camera.keys[i - 1].time))
            problems.push_back({json.find("keys")->items[i].where,
                                fmt::format("the times of 'keys' must rise: {} does not come after {}",
                                            camera.keys[i].time, camera.keys[i - 1].time)});
}

} // namespace

const SetupKeys<AddedCameraKey>& addedCameraKeyKeys() {
    static const auto keys = [] {
        SetupKeys<AddedCameraKey> made;
        made.add({"time",
                  "Seconds",
                  Json::Kind::Float,
                  {{"type", "number"}, {"minimum", 0}, {"maximum", largestTime}, {"default", 0}},
                  [](std::vector<Problem>& problems, const Json& json, AddedCameraKey& into) {
                      into.time = json.number;
                      if (!(json.number >= 0 && json.number <= largestTime))
                          problems.push_back({json.where, fmt::format("'time' must be from 0 to {}, not {}",
                                                                      largestTime, json.number)});
                  },
                  [](const AddedCameraKey& from) { return fmt::format("{}", from.time); },
                  [](AddedCameraKey& under, const AddedCameraKey& over) { under.time = over.time; }});
        made.vector("eye", &AddedCameraKey::eye, "Instead of the camera's")
            .vector("target", &AddedCameraKey::target, "Instead of the camera's")
            .vector("up", &AddedCameraKey::up, "Instead of the camera's")
            .number("fov", &AddedCameraKey::fov, 0, 180, true, "Instead of the camera's");
        return made;
    }();
    return keys;
}

const SetupKeys<AddedCamera>& addedCameraKeys() {
    static const auto keys =
        SetupKeys<AddedCamera>()
            .text("name", &AddedCamera::name, "By which it can be told from others; default: added")
            .text("path", &AddedCamera::path,
                  "A JSON file with \"kestrel_camera\": 1 and these keys, for what is not given here")
            .text("node", &AddedCamera::node,
                  "A node of the scene: coordinates are in its space, and the camera moves along")
            .vector("eye", &AddedCamera::eye, "Where it stands")
            .vector("target", &AddedCamera::target, "The point in the middle of the picture")
            .vector("up", &AddedCamera::up, "Upward in the picture; default: y, or -z straight up or down")
            .number("fov", &AddedCamera::fov, 0, 180, true, "Vertical field of view, degrees; default: 45")
            .number("near", &AddedCamera::nearPlane, 0, largestLength, true,
                    "Nearest that is seen; default: a hundredth of the way from eye to target")
            .number("far", &AddedCamera::farPlane, 0, largestLength, true,
                    "Farthest that is seen; default: without end")
            .choice("interpolation", &AddedCamera::interpolation, {"linear", "smooth"},
                    "Between keys: straight lines, or a cubic curve through them")
            .list("keys", &AddedCamera::keys, addedCameraKeyKeys, "a key of the camera", mostKeys,
                  "A path: where the camera is at rising times")
            .finally(checkCameraKeys);
    return keys;
}

const SetupKeys<AddedLight>& addedLightKeys() {
    static const auto keys = [] {
        SetupKeys<AddedLight> made;
        made.add({"kind",
                  fmt::format("{}", fmt::join(lightKindNames(), ", ")),
                  Json::Kind::String,
                  {{"enum", lightKindNames()}, {"default", lightKindNames().front()}},
                  [](std::vector<Problem>& problems, const Json& json, AddedLight& into) {
                      const auto& names = lightKindNames();
                      const auto found = std::ranges::find(names, json.text);
                      if (found != names.end())
                          into.kind = static_cast<LightKind>(found - names.begin());
                      else
                          problems.push_back(
                              {json.where,
                               fmt::format("the kind of a light must be one of {}, not '{}'{}",
                                           fmt::join(names, ", "), json.text, didYouMean(json.text, names))});
                  },
                  [](const AddedLight& from) {
                      return "\"" + lightKindNames()[static_cast<size_t>(from.kind)] + "\"";
                  },
                  [](AddedLight& under, const AddedLight& over) { under.kind = over.kind; }});
        made.text("name", &AddedLight::name, "For the reader")
            .text("node", &AddedLight::node,
                  "A node of the scene: coordinates are in its space, and the light moves along")
            .vector("position", &AddedLight::position, "Where it is (not of directional)")
            .vector("direction", &AddedLight::direction,
                    "Into which it shines (of directional, spot, rectangle)")
            .vector("target", &AddedLight::target,
                    "The point at which it shines, instead of 'direction' (of spot, rectangle)")
            .vector("up", &AddedLight::up, "Along the height (of rectangle)")
            .vector("color", &AddedLight::color, "Linear red, green, blue; default: 1, 1, 1", 0)
            .number("intensity", &AddedLight::intensity, 0, 1e12, false,
                    "Candela (point, spot), lux (directional) or radiance (rectangle, sphere); default: 1")
            .number("range", &AddedLight::range, 0, largestLength, true,
                    "Beyond it there is no light (of point, spot); default: without end")
            .number("inner", &AddedLight::innerCone, 0, 90, false,
                    "Half angle within which it shines in full, degrees (of spot); default: 0")
            .number("outer", &AddedLight::outerCone, 0, 90, false,
                    "Half angle of the whole cone, degrees (of spot); default: 45")
            .number("width", &AddedLight::width, 0, largestLength, true, "Of rectangle")
            .number("height", &AddedLight::height, 0, largestLength, true, "Of rectangle")
            .number("radius", &AddedLight::radius, 0, largestLength, true, "Of sphere")
            .finally(checkLight);
        return made;
    }();
    return keys;
}

const SetupKeys<SceneSetup>& sceneSetupKeys() {
    static const auto keys = [] {
        SetupKeys<SceneSetup> made;
        made.add({"camera",
                  "A camera of the scene by its name or number, or one of your own",
                  std::nullopt,
                  {{"anyOf", {{{"type", "string"}}, addedCameraKeys().schema()}}},
                  [](std::vector<Problem>& problems, const Json& json, SceneSetup& into) {
                      if (json.kind == Json::Kind::String)
                          into.cameraName = json.text;
                      else if (json.kind == Json::Kind::Object)
                          addedCameraKeys().read(problems, json, "the camera", into.camera.emplace());
                      else
                          problems.push_back(
                              {json.where, fmt::format("'camera' must be a string, which names one of the "
                                                       "scene, or an object, which adds one, not {}",
                                                       json.kindName())});
                  },
                  [](const SceneSetup& from) {
                      return !from.cameraName.empty() ? jsonQuoted(from.cameraName)
                             : from.camera            ? cameraText(*from.camera)
                                                      : std::string();
                  },
                  [](SceneSetup& under, const SceneSetup& over) {
                      if (over.cameraName.empty() && !over.camera) return;
                      under.cameraName = over.cameraName;
                      under.camera = over.camera;
                  }});
        made.list("lights", &SceneSetup::lights, addedLightKeys, "a light", mostLights,
                  "Lights beside those of the scene")
            .text("animation", &SceneSetup::animation,
                  "Which one plays: its name or number, \"none\", or \"all\" (the default)")
            .number("time", &SceneSetup::time, 0, largestTime, false,
                    "Of the first frame, seconds; default: 0")
            .number("fps", &SceneSetup::fps, 0, 1e6, true,
                    "Frames a second of the scene's time; default: 60");
        return made;
    }();
    return keys;
}

} // namespace kestrel
