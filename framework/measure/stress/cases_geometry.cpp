// Geometry that is hard, and how many surfaces lie behind a pixel.
#include "measure/stress/stress_case.h"
#include <fmt/format.h>

namespace kestrel {

void addGeometryCases(std::vector<StressCase>& cases) {
    const auto scene = [&](const char* name, const char* source, const char* does,
                           StressExpects expects = StressExpects::Nothing) {
        cases.push_back({.name = std::string("geometry/") + name,
                         .kind = StressKind::Geometry,
                         .does = does,
                         .scene = std::string("builtin:stress_") + source,
                         .expects = expects});
    };
    scene("empty", "empty", "No triangle");
    scene("one", "one", "One triangle");
    scene("point", "point", "One triangle without extent, and nothing else");
    scene("degenerate", "degenerate", "Triangles that are a point, a line, or one last bit wide");
    scene("slivers", "slivers", "Triangles as high as 1e-7 of their length");
    scene("needles", "needles", "Needles along the axes");
    scene("coincident", "coincident", "The same square six times");
    scene("coplanar", "coplanar", "Squares of other sizes in one plane");
    scene("interpenetrating", "interpenetrating", "Triangles that cut each other", StressExpects::AnyOrder);
    scene("column", "column?count=1000000", "A million triangles in one column of pixels");
    scene("huge", "huge", "A triangle far larger than the far plane");
    scene("voxel", "voxel", "A mesh inside one cell of a map");
    scene("borders", "borders", "Squares on the borders of cells");

    const auto edit = [&](const char* name, const char* does, SceneEdit changed,
                          StressExpects expects = StressExpects::Nothing) {
        cases.push_back({.name = std::string("geometry/") + name,
                         .kind = StressKind::Geometry,
                         .does = does,
                         .edit = std::move(changed),
                         .expects = expects});
    };
    edit("reversed", "The triangles in the opposite order", {.triangles = SceneEdit::Triangles::Reversed},
         StressExpects::Same);
    edit("doubled", "Each triangle twice", {.triangles = SceneEdit::Triangles::Doubled});
    edit("open", "Every second triangle left out", {.triangles = SceneEdit::Triangles::Halved});
    edit("inside_out", "Windings and normals turned round", {.triangles = SceneEdit::Triangles::InsideOut});

    for (const int count : {1, 10, 100, 1000})
        cases.push_back({.name = fmt::format("layers/{}", count),
                         .kind = StressKind::Layers,
                         .does = fmt::format("{} surface{} behind a pixel", count, count == 1 ? "" : "s"),
                         .scene = fmt::format("builtin:stress_layers?count={}", count),
                         .expects = StressExpects::AnyOrder});
    cases.push_back({.name = "layers/bucket",
                     .kind = StressKind::Layers,
                     .does = "64 surfaces within a hundred thousandth of a pixel's depths",
                     .scene = "builtin:stress_bucket?count=64",
                     .expects = StressExpects::AnyOrder});
    cases.push_back({.name = "layers/equal",
                     .kind = StressKind::Layers,
                     .does = "32 surfaces at one depth: a pixel's least and greatest are equal",
                     .scene = "builtin:stress_equal?count=32"});
}

} // namespace kestrel
