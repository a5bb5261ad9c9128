// Stiff and extreme cases as data: what each does to scene, camera, frame and properties, and what must hold
// then. What is run of them: stress_run.h.
#pragma once
#include "graph/graph.h"
#include "scene/edit.h"
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kestrel {

enum class StressKind : std::uint8_t {
    Numbers,
    Scale,
    Place,
    Turn,
    Depth,
    Frame,
    Geometry,
    Layers, // depth complexity
    Light,  // and material
    Rays,
    Time
};
[[nodiscard]] std::string_view stressKindName(StressKind kind); // "numbers", "scale", …

// What must hold besides that every value of every output of every pass is finite and within the range that
// its port states.
enum class StressExpects : std::uint8_t {
    Nothing,   // more
    Same,      // the plain picture
    Mirrored,  // the plain picture, left and right exchanged
    AnyOrder,  // the picture of the same triangles in the opposite order
    Recovers,  // after the events the picture that is there without them
    EnergyHeld // no light beyond what a closed room of that reflectance has
};
[[nodiscard]] std::string_view stressExpectsName(StressExpects expects); // "same", "order", …

// Sets every property of that name, or whose unit is that one, to one end of its range or to a value.
struct StressProperty {
    enum class To : std::uint8_t { Least, Most, Given };
    std::string_view name = {}, unit = {}; // either may be empty
    To to = To::Given;
    double value = 0;
};

// What happens before a frame is rendered.
struct StressEvent {
    enum class What : std::uint8_t {
        Camera,   // a camera of its own, so many radii of the scene to the right of where it stood
        Cut,      // back to the scene's camera
        TimeStep, // seconds
        Pause,    // 1: the time stands still, 0: it goes on
    };
    int frame = 0;
    What what = What::Camera;
    double value = 0;
};

struct StressCase {
    std::string name = {}; // "scale/1e6"
    StressKind kind = StressKind::Numbers;
    std::string does = {};  // one sentence without full stop
    std::string scene = {}; // "builtin:stress_…"; empty: the one that the user gave
    SceneEdit edit = {};
    std::optional<Extent> size = {};
    int frames = 4;
    std::uint32_t seed = 0;
    bool keepAll = false, noSharing = false, countIterations = false;
    std::vector<StressProperty> properties = {};
    std::vector<StressEvent> events = {}; // in order of their frames
    StressExpects expects = StressExpects::Nothing;
    double reflectance = 0; // of EnergyHeld: the room shines with radiance 1
};

// All of them, by kind.
[[nodiscard]] const std::vector<StressCase>& stressCases();
// The parts of that list, each in a file of its own.
void addSpaceCases(std::vector<StressCase>& cases);    // scale, place, turn
void addViewCases(std::vector<StressCase>& cases);     // depth, frame
void addGeometryCases(std::vector<StressCase>& cases); // geometry, layers
void addLightCases(std::vector<StressCase>& cases);    // light and material
void addRunCases(std::vector<StressCase>& cases);      // numbers, rays, time

// The indices of the cases that `only` chooses: one by its name, or all of a kind ("scale"); all where it is
// empty. Throws InputError with the near name.
[[nodiscard]] std::vector<size_t> chooseStressCases(const std::string& only);

// What a point of a closed room that shines with radiance 1 sends out at most, by as many bounces n as the
// graph follows (the greatest property `bounces`, else 1): 1 + rho + ... + rho^n.
[[nodiscard]] double closedRoomLight(const Graph& graph, const Registry& registry, double reflectance);

// The graph with the lengths among its properties (those whose unit is the scene's) times `scale`, then with
// what the case sets. A property that is not given has its default scaled; a value beyond the property's
// range becomes the nearer end.
[[nodiscard]] Graph stressGraph(Graph graph, const Registry& registry, double scale,
                                std::span<const StressProperty> properties);

} // namespace kestrel
