#include "roma.h"
#include "execute/commands.h"
#include "grid.h"
#include "tracing.h"
#include <bit>
#include <fmt/format.h>

namespace kestrel {
namespace {

struct Maps {
    int resolution = 0, directions = 0;
    Desc desc;
    [[nodiscard]] int words() const { return resolution / 32; }
};

Maps mapsOf(int resolution, int angular) {
    Maps maps{resolution, angular * angular, {}};
    maps.desc = Desc::buffer(occupancyBytes(resolution) * static_cast<std::uint64_t>(maps.directions),
                             columnFormat(maps.words()));
    return maps;
}

Defines sizes(const Maps& maps) {
    return {{"RESOLUTION", std::to_string(maps.resolution)},
            {"WORDS", std::to_string(maps.words())},
            {"DIRECTIONS", std::to_string(maps.directions)}};
}

Step rotateStep(const Maps& maps, const Desc& base, bool inTurn, const Capabilities& capabilities) {
    Step step{.name = "rotate",
              .shaders = {"occupancy/rotate.comp"},
              .defines = sizes(maps),
              .uses = {{.port = "occupancy", .access = Access::Image},
                       {.port = "rotations", .access = Access::Uniform},
                       {.port = "maps", .access = Access::Storage, .write = true}},
              .modules = {},
              .group = "generation"};
    step.defines["RESOLUTION_BITS"] =
        std::to_string(std::countr_zero(static_cast<unsigned>(maps.resolution)));
    if (inTurn) step.defines.emplace("IN_TURN", "1");
    if (!fitsTexels(base, capabilities)) {
        step.defines.emplace("BASE_STORAGE", "1");
        step.uses.front().access = Access::Storage;
    }
    return step;
}

} // namespace

PassType Roma::type() {
    return Describe<Roma>("Roma",
                          "Ray-aligned occupancy map array: an occupancy map rotated towards many directions")
        .input("occupancy", PortKind::Buffer, "Base occupancy map")
        .input("grid", PortKind::Buffer, "Where its cells lie")
        .output("tracer", PortKind::Tracer,
                "Traces through the rotated maps, snapping where the consumer bears it")
        .internal("maps", PortKind::Buffer,
                  "The rotated maps, columns of words along each candidate direction")
        .internal("directions", PortKind::Buffer, "The candidate directions and their strata")
        .internal("rotations", PortKind::Buffer, "The rotated maps' axes in fixed point")
        .internal("exhausted", PortKind::Buffer,
                  "Rays traced without snapping, and those that ran out of iterations")
        .number("angular", &Roma::angular, 2, 16, "strata per axis",
                "Angular resolution: its square is the number of rotated maps")
        .number("iterations", &Roma::iterations, 1, 256, "columns",
                "How many columns a ray that is not snapped may cross; then it counts as unoccluded")
        .number("offset", &Roma::offset, 0, 8, "cells",
                "How far ray origins are moved off the surface, along its normal")
        .number("skip", &Roma::skip, 0, 8, "cells", "How far rays from a surface go before anything counts")
        .flag("resample", &Roma::resample, "New candidate directions every frame; otherwise those of frame 0")
        .number("refresh", &Roma::refresh, 0, 256, "maps",
                "How many maps a frame renews, in turn, while the occupancy map stays as it is; 0: all")
        .flag("count_exhausted", &Roma::countExhausted,
              "Counts the rays that ran out of iterations and reports them with the next frame");
}

Declaration Roma::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const std::optional<int> resolution = mapResolution(inputs, declaration);
    if (!resolution) return declaration;
    const Desc& base = inputs["occupancy"].desc;
    const Maps maps = mapsOf(*resolution, angular);
    const std::int64_t limit = world.capabilities.maxStorageBlockBytes;
    if (maps.desc.bytes > static_cast<std::uint64_t>(limit)) {
        declaration.problems.push_back(
            {"tracer",
             fmt::format("{} maps of {} cells an edge need {} bytes in one storage block; the limit is {}",
                         maps.directions, maps.resolution, maps.desc.bytes, limit)});
        return declaration;
    }
    declaration.outputs = {{.port = "tracer", .desc = Desc::module(gives::Snaps | gives::Approximate)}};
    if (!demand.reads("tracer")) return declaration;

    const auto directions = static_cast<std::uint64_t>(maps.directions);
    const std::uint64_t block =
        sizeof(shared::OccupancySettings) + sizeof(shared::RomaDirection) * directions;
    declaration.outputs.push_back({.port = "directions", .desc = Desc::buffer(block)});
    Module tracer{.port = "tracer",
                  .shader = "occupancy/roma.glsl",
                  .defines = sizes(maps),
                  .uses = {{.port = "grid", .access = Access::Uniform},
                           {.port = "directions", .access = Access::Uniform}},
                  .modules = {}};
    tracer.defines["ANGULAR"] = std::to_string(angular);
    tracer.defines["ITERATIONS"] = std::to_string(iterations);
    Step candidates{.name = "candidates",
                    .shaders = {},
                    .defines = {},
                    .uses = {{.port = "directions", .access = Access::Copy, .write = true}},
                    .modules = {},
                    .group = "generation"};

    const bool empty = inputs["occupancy"].constant == glm::vec4(0);
    if (empty) {
        tracer.defines["EMPTY"] = "1";
        declaration.leftOut.push_back({"rotated maps", "the occupancy map is empty"});
        declaration.steps = {candidates};
    } else {
        const bool image = fitsTexels(maps.desc, world.capabilities);
        if (!image) tracer.defines["MAPS_STORAGE"] = "1";
        tracer.uses.push_back({.port = "maps", .access = image ? Access::Image : Access::Storage});
        // Renewed in turn: those of earlier frames are traced on.
        const bool inTurn = resample && refresh > 0 && refresh < maps.directions;
        declaration.outputs.push_back({.port = "maps", .desc = maps.desc, .keeps = inTurn});
        if (refresh > 0 && !resample)
            declaration.leftOut.push_back({"renewing maps in turn", "the candidates stay as they are"});
        declaration.outputs.push_back(
            {.port = "rotations", .desc = Desc::buffer(sizeof(shared::RomaRotation) * directions)});
        candidates.uses.push_back({.port = "rotations", .access = Access::Copy, .write = true});
        if (countExhausted) exhaustion::declare(declaration, tracer, candidates);
        declaration.steps.push_back(candidates);
        declaration.steps.push_back(rotateStep(maps, base, inTurn, world.capabilities));
    }
    declaration.modules.push_back(std::move(tracer));
    if (resample) declaration.depends = Causes::Frame;
    return declaration;
}

void Roma::execute(const Step& step, Commands& commands) {
    if (step.name == "report") return exhaustion::report(commands);
    if (step.name == "candidates") return upload(step, commands);
    const auto n = static_cast<std::uint32_t>(*occupancyResolution(commands.desc("occupancy")));
    if (step.defines.contains("IN_TURN")) {
        commands.set("firstPlace", renewal_.first);
        commands.set("placeStride", renewalStride(angular * angular));
    }
    commands.dispatchOver(n, n, static_cast<std::uint32_t>(renewal_.count));
}

void Roma::upload(const Step& step, Commands& commands) {
    const bool changed = any(commands.causes() & ~Causes::Frame) ||
                         any(commands.causes("occupancy") | commands.causes("grid"));
    const FrameInfo& frame = commands.frame();
    renewal_ =
        candidates_.draw(angular, resample ? refresh : 0, changed, resample ? frame.index : 0, frame.seed);
    commands.uploadValue("directions", shared::OccupancySettings{offset, skip, 0, 0});
    const std::vector<shared::RomaDirection>& strata = candidates_.strata();
    commands.upload("directions", strata, sizeof(shared::OccupancySettings));
    if (usesPort(step, "rotations")) {
        std::vector<shared::RomaRotation> rotations;
        for (const shared::RomaDirection& stratum : strata)
            rotations.push_back(romaRotation(stratum.direction));
        commands.upload("rotations", rotations);
    }
    if (usesPort(step, "exhausted")) exhaustion::clear(commands);
}

} // namespace kestrel
