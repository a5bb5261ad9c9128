// How a graph is run, rays at their ends, and what happens over time.
#include "draw/view_data.h"
#include "measure/stress/stress_case.h"

namespace kestrel {
namespace {

void addNumbers(std::vector<StressCase>& cases) {
    const auto kind = StressKind::Numbers;
    cases.push_back({.name = "numbers/plain", .kind = kind, .does = "Graph and scene as they are"});
    cases.push_back({.name = "numbers/keep_all",
                     .kind = kind,
                     .does = "Nothing is left out: every output of every pass",
                     .keepAll = true,
                     .expects = StressExpects::Same});
    cases.push_back({.name = "numbers/no_sharing",
                     .kind = kind,
                     .does = "Each resource has memory of its own",
                     .noSharing = true,
                     .expects = StressExpects::Same});
    cases.push_back({.name = "numbers/seed",
                     .kind = kind,
                     .does = "The greatest seed",
                     .seed = 0xffffffffU,
                     .expects = StressExpects::Same});
    cases.push_back({.name = "numbers/iterations",
                     .kind = kind,
                     .does = "No loop makes more iterations than every driver runs",
                     .countIterations = true,
                     .expects = StressExpects::Same});
}

void addRays(std::vector<StressCase>& cases) {
    const auto kind = StressKind::Rays;
    cases.push_back(
        {.name = "rays/axes",
         .kind = kind,
         .does = "Boxes along the axes, seen along one: rays along axes, through edges and corners",
         .scene = "builtin:stress_corners"});
    cases.push_back({.name = "rays/corners",
                     .kind = kind,
                     .does = "The same in a frame whose pixels' centres meet the lattice",
                     .scene = "builtin:stress_corners",
                     .size = Extent{33, 33, 1}});
    cases.push_back({.name = "rays/borders",
                     .kind = kind,
                     .does = "Squares on the borders of cells, seen along an axis",
                     .scene = "builtin:stress_borders",
                     .edit = {.eye = glm::dvec3(0, 0, 3)}});
    cases.push_back({.name = "rays/outside",
                     .kind = kind,
                     .does = "The eye a hundred radii outside of every map",
                     .edit = {.fov = 2, .farOverNear = 0, .eye = glm::dvec3(60, 55, 58)}});
    cases.push_back({.name = "rays/inside",
                     .kind = kind,
                     .does = "The eye in the middle of a lattice of boxes, in one of them",
                     .scene = "builtin:stress_corners",
                     .edit = {.eye = glm::dvec3(0, 0, 1e-3)}});
    cases.push_back({.name = "rays/no_length",
                     .kind = kind,
                     .does = "Every length among the properties at its least",
                     .properties = {{.name = "", .unit = "scene units", .to = StressProperty::To::Least}}});
    cases.push_back({.name = "rays/any_length",
                     .kind = kind,
                     .does = "Every length among the properties at its greatest",
                     .properties = {{.name = "", .unit = "scene units", .to = StressProperty::To::Most}}});
}

void addTime(std::vector<StressCase>& cases) {
    using What = StressEvent::What;
    const auto kind = StressKind::Time;
    // A whole period of the jitter before and one after, so that both pictures end at the same offset.
    const int period = static_cast<int>(jitterPeriod);
    const auto recovers = [&](const char* name, const char* does, std::vector<StressEvent> events,
                              SceneEdit edit = {}) {
        edit.dropAnimations = true;
        cases.push_back({.name = std::string("time/") + name,
                         .kind = kind,
                         .does = does,
                         .edit = std::move(edit),
                         .frames = 2 * period,
                         .events = std::move(events),
                         .expects = StressExpects::Recovers});
    };
    recovers("cut", "A cut to another camera and back", {{20, What::Camera, 0.4}, {24, What::Cut}});
    recovers("jump", "The camera jumps a thousand radii away and back",
             {{0, What::Camera, 0}, {20, What::Camera, 1e3}, {24, What::Camera, 0}});
    std::vector<StressEvent> moves, shakes;
    for (int i = 0; i <= 20; ++i) moves.push_back({i, What::Camera, 0.02 * (20 - i)});
    for (int i = 0; i <= 20; ++i) shakes.push_back({i, What::Camera, i == 20 || i % 2 == 0 ? 0 : 0.05});
    recovers("stop", "A camera that moves and stops", std::move(moves));
    recovers("shake", "A camera that shakes", std::move(shakes));
    recovers("blink", "Lights that are on and off from frame to frame", {{21, What::Pause, 1}},
             {.lights = {{.kind = LightKind::Point, .place = {0.4, 0.8, 0.6}}}, .blinkFrames = 40});
    const auto runs = [&](const char* name, const char* does, std::vector<StressEvent> events) {
        cases.push_back({.name = std::string("time/") + name,
                         .kind = kind,
                         .does = does,
                         .frames = 12,
                         .events = std::move(events)});
    };
    runs("no_step", "A time step of 0", {{2, What::TimeStep, 0}});
    runs("tiny_step", "A time step of 1e-12 seconds", {{2, What::TimeStep, 1e-12}});
    runs("huge_step", "A time step of a million seconds", {{2, What::TimeStep, 1e6}});
    runs("odd_steps", "Time steps that change by decades",
         {{2, What::TimeStep, 1e-6},
          {4, What::TimeStep, 0.1},
          {6, What::TimeStep, 3},
          {8, What::TimeStep, 0.016}});
}

} // namespace

void addRunCases(std::vector<StressCase>& cases) {
    addNumbers(cases);
    addRays(cases);
    addTime(cases);
}

} // namespace kestrel
