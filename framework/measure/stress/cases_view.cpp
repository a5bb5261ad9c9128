// Cameras and frames at their ends.
#include "measure/stress/stress_case.h"
#include <fmt/format.h>

namespace kestrel {

void addViewCases(std::vector<StressCase>& cases) {
    const auto depth = [&](const std::string& name, const std::string& does, SceneEdit edit,
                           StressExpects expects = StressExpects::Nothing) {
        cases.push_back({.name = "depth/" + name,
                         .kind = StressKind::Depth,
                         .does = does,
                         .edit = std::move(edit),
                         .expects = expects});
    };
    for (const double ratio : {1e2, 1e4, 1e6, 1e8})
        depth(fmt::format("far_over_near_{:g}", ratio),
              fmt::format("The far plane {:g} times as far as the near plane", ratio), {.farOverNear = ratio},
              ratio >= 1e6 ? StressExpects::Same : StressExpects::Nothing);
    depth("infinite", "The far plane infinitely far", {.farOverNear = 0}, StressExpects::Same);
    depth("near_1e-3", "The near plane at a thousandth of its distance, the far plane infinitely far",
          {.nearFactor = 1e-3, .farOverNear = 0}, StressExpects::Same);
    depth("near_1e-6", "The near plane at a millionth of its distance, the far plane at 1e8 times that",
          {.nearFactor = 1e-6, .farOverNear = 1e8});
    for (const double fov : {1.0, 10.0, 120.0, 170.0})
        depth(fmt::format("fov_{:g}", fov), fmt::format("A field of view of {:g} degrees", fov),
              {.fov = fov});
    depth("orthographic", "Cameras without perspective", {.orthographic = true});
    depth("orthographic_near",
          "Cameras without perspective whose far plane is 1e6 times as far as the near plane",
          {.nearFactor = 1e-3, .farOverNear = 1e6, .orthographic = true});

    const auto frame = [&](std::uint32_t width, std::uint32_t height, const char* does) {
        cases.push_back({.name = fmt::format("frame/{}x{}", width, height),
                         .kind = StressKind::Frame,
                         .does = does,
                         .size = Extent{width, height, 1},
                         .frames = 2});
    };
    frame(1, 1, "A frame of one pixel");
    frame(1, 64, "A frame of one column");
    frame(64, 1, "A frame of one row");
    frame(2, 3, "A frame smaller than any work group");
    frame(33, 17, "A frame of odd sides");
    frame(127, 1021, "A frame of prime sides");
    frame(8192, 4, "A frame 8192 pixels wide");
    frame(4, 8192, "A frame 8192 pixels high");
    cases.push_back({.name = "frame/guard",
                     .kind = StressKind::Frame,
                     .does = "A guard band larger than the frame",
                     .size = Extent{24, 16, 1},
                     .frames = 2,
                     .properties = {{.name = "guard", .unit = "pixels", .value = 96}}});
    cases.push_back({.name = "frame/divisor",
                     .kind = StressKind::Frame,
                     .does = "The coarsest maps in a frame of odd sides",
                     .size = Extent{35, 19, 1},
                     .frames = 2,
                     .properties = {{.name = "divisor", .unit = "", .to = StressProperty::To::Most}}});
}

} // namespace kestrel
