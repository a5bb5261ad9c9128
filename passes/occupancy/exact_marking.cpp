#include "exact_marking.h"
#include "draw/material_defines.h"
#include "execute/commands.h"
#include <algorithm>

namespace kestrel {
namespace {

void markLargeTriangles(Commands& commands) { commands.dispatchIndirect("large"); }

} // namespace

Defines markingDefines(const World& world, int resolution) {
    Defines defines = world.facts.hasMasked ? materialDefines(world.facts) : Defines{};
    defines["RESOLUTION"] = std::to_string(resolution);
    return defines;
}

std::vector<Step> exactSteps(const World& world, int resolution) {
    Step small{.name = "triangles",
               .run = markTriangles,
               .shaders = {"occupancy/exact.comp"},
               .defines = markingDefines(world, resolution),
               .uses = {{.port = "grid", .access = Access::Uniform},
                        {.port = "occupancy", .access = Access::Storage, .write = true},
                        {.port = "large", .access = Access::Storage, .write = true}},
               .group = "generation"};
    Step large = small;
    large.name = "large_triangles";
    large.run = markLargeTriangles;
    large.defines["LARGE"] = "1";
    large.uses.back().write = false;
    large.uses.push_back({.port = "large", .access = Access::Indirect});
    return {small, large};
}

std::vector<Step> separatingSteps(const World& world, int resolution, float inset) {
    std::vector<Step> steps = exactSteps(world, resolution);
    for (Step& step : steps) step.defines["SEPARATING"] = "1";
    const auto sided = [inset](Commands& commands) {
        const auto first = [&](TriangleClass c) {
            return static_cast<int>(commands.geometry().ranges[static_cast<std::size_t>(c)].first);
        };
        commands.set("inset", inset);
        commands.set("classes",
                     glm::ivec3(first(TriangleClass::OpaqueDoubleSided), first(TriangleClass::Masked),
                                first(TriangleClass::MaskedDoubleSided)));
    };
    steps[0].run = [sided](Commands& commands) {
        sided(commands);
        markTriangles(commands);
    };
    steps[1].run = [sided](Commands& commands) {
        sided(commands);
        markLargeTriangles(commands);
    };
    return steps;
}

// An indirect command and the count stand in front of the list.
Desc largeTrianglesDesc(const World& world) { return Desc::buffer(16 + 4 * world.facts.triangles); }

void markTriangles(Commands& commands) {
    const std::uint32_t triangles = commands.geometry().triangleCount();
    constexpr std::uint32_t group = 64,
                            row = 32768; // invocations a group; groups along x, below every device's limit
    const std::uint32_t groups = std::max(1u, (triangles + group - 1) / group);
    commands.set("triangleCount", static_cast<int>(triangles));
    commands.dispatch(std::min(groups, row), (groups + row - 1) / row);
}

} // namespace kestrel
