// A scene as a whole is larger, elsewhere or turned: the picture stays.
#include "measure/stress/stress_case.h"
#include <fmt/format.h>

namespace kestrel {

void addSpaceCases(std::vector<StressCase>& cases) {
    for (const double scale : {1e-6, 1e-4, 1e-2, 1e2, 1e4, 1e6})
        cases.push_back({.name = fmt::format("scale/{:g}", scale),
                         .kind = StressKind::Scale,
                         .does = fmt::format("Scene and all lengths among the properties times {:g}", scale),
                         .edit = {.scale = scale},
                         .expects = StressExpects::Same});

    for (const double radii : {1.0, 1e2, 1e4, 1e6})
        cases.push_back({.name = fmt::format("place/{:g}", radii),
                         .kind = StressKind::Place,
                         .does = fmt::format("The scene moved by {:g} times its radius", radii),
                         .edit = {.move = radii * glm::dvec3(0.75, -0.55, 0.37)},
                         .expects = StressExpects::Same});
    cases.push_back({.name = "place/axis",
                     .kind = StressKind::Place,
                     .does = "The scene moved by a million times its radius along one axis",
                     .edit = {.move = glm::dvec3(-1e6, 0, 0)},
                     .expects = StressExpects::Same});
    cases.push_back({.name = "place/small_and_far",
                     .kind = StressKind::Place,
                     .does = "A thousandth of its size, and moved by a million times its radius",
                     .edit = {.scale = 1e-3, .move = 1e6 * glm::dvec3(0.37, 0.75, -0.55)},
                     .expects = StressExpects::Same});

    const auto turn = [&](const char* name, const char* does, const glm::dvec3& degrees, bool mirror) {
        cases.push_back({.name = std::string("turn/") + name,
                         .kind = StressKind::Turn,
                         .does = does,
                         .edit = {.turn = degrees, .mirror = mirror},
                         .expects = mirror ? StressExpects::Mirrored : StressExpects::Same});
    };
    turn("yaw_90", "Turned by 90 degrees about y", {0, 90, 0}, false);
    turn("yaw_33", "Turned by 33 degrees about y", {0, 33, 0}, false);
    turn("pitch_90", "Turned by 90 degrees about x", {90, 0, 0}, false);
    turn("upside_down", "Turned by 180 degrees about z", {0, 0, 180}, false);
    turn("oblique", "Turned about all three axes", {31, 57, 23}, false);
    turn("mirror", "Mirrored in x", {0, 0, 0}, true);
    turn("mirror_yaw", "Turned by 57 degrees about y and mirrored in x", {0, 57, 0}, true);
}

} // namespace kestrel
