#include "roma.h"
#include "candidates.h"
#include "core/check.h"
#include "execute/commands.h"
#include "grid.h"
#include <algorithm>
#include <bit>
#include <cstring>
#include <fmt/format.h>

namespace kestrel {
namespace {

// A rotated map's column is read as this texel (two of them at 256 cells).
Format columnFormat(int words) {
    if (words == 1) return Format::R32UI;
    return words == 2 ? Format::RG32UI : Format::RGBA32UI;
}

// Random reads go through image units where the texels fit a texture buffer (measured twice as fast and more
// on a CPU driver), else through a storage block.
bool fitsTexels(const Desc& buffer, const Capabilities& capabilities) {
    const auto texels = buffer.bytes / static_cast<std::uint64_t>(formatInfo(buffer.format).bytes);
    return texels <= static_cast<std::uint64_t>(capabilities.maxTextureBufferTexels);
}

// The storage block `Exhausted` of occupancy/roma.glsl.
struct ExhaustedRays {
    std::uint32_t rays = 0, exhausted = 0;
    std::uint32_t begun = 0x52414d45; // tells a buffer that counting began with from one that is new
};

bool uses(const Step& step, std::string_view port) {
    return std::any_of(step.uses.begin(), step.uses.end(), [&](const Use& use) { return use.port == port; });
}

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

Step rotateStep(const Maps& maps, const Desc& base, const Capabilities& capabilities) {
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
        .flag("count_exhausted", &Roma::countExhausted,
              "Counts the rays that ran out of iterations and reports them with the next frame");
}

Declaration Roma::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const Desc& base = inputs["occupancy"].desc;
    const std::optional<int> resolution = occupancyResolution(base);
    if (!resolution) {
        declaration.problems.push_back(
            {"occupancy",
             fmt::format("is no occupancy map of 32, 64, 128 or 256 cells an edge: {}", describe(base))});
        return declaration;
    }
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
    const std::uint64_t block = sizeof(shared::RomaSettings) + sizeof(shared::RomaDirection) * directions;
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
        declaration.outputs.push_back({.port = "maps", .desc = maps.desc});
        declaration.outputs.push_back(
            {.port = "rotations", .desc = Desc::buffer(sizeof(shared::RomaRotation) * directions)});
        candidates.uses.push_back({.port = "rotations", .access = Access::Copy, .write = true});
        if (countExhausted) {
            tracer.defines["COUNT_EXHAUSTED"] = "1";
            tracer.uses.push_back({.port = "exhausted", .access = Access::Storage, .write = true});
            declaration.outputs.push_back(
                {.port = "exhausted", .desc = Desc::buffer(sizeof(ExhaustedRays)), .keeps = true});
            candidates.uses.push_back({.port = "exhausted", .access = Access::Copy, .write = true});
            declaration.steps.push_back({.name = "report",
                                         .shaders = {},
                                         .defines = {},
                                         .uses = {{.port = "exhausted", .access = Access::Host}},
                                         .modules = {}});
            declaration.always = true;
        }
        declaration.steps.push_back(candidates);
        declaration.steps.push_back(rotateStep(maps, base, world.capabilities));
    }
    declaration.modules.push_back(std::move(tracer));
    if (resample) declaration.depends = Causes::Frame;
    return declaration;
}

void Roma::execute(const Step& step, Commands& commands) {
    if (step.name == "report") return reportExhausted(commands);
    if (step.name == "candidates") return upload(step, commands);
    const auto n = static_cast<std::uint32_t>(*occupancyResolution(commands.desc("occupancy")));
    commands.dispatchOver(n, n, static_cast<std::uint32_t>(angular * angular));
}

void Roma::upload(const Step& step, Commands& commands) {
    if (strataAngular_ != angular) {
        strata_ = romaStrata(angular);
        strataAngular_ = angular;
    }
    drawCandidates(strata_, angular, resample ? commands.frame().index : 0, commands.frame().seed);
    commands.uploadValue("directions", shared::RomaSettings{offset, skip, 0, 0});
    commands.upload("directions", strata_, sizeof(shared::RomaSettings));
    const auto n = strata_.size();
    if (uses(step, "rotations")) {
        std::vector<shared::RomaRotation> rotations(n);
        for (size_t i = 0; i < n; ++i) rotations[i] = romaRotation(strata_[i].direction);
        commands.upload("rotations", rotations);
    }
    if (uses(step, "exhausted")) commands.uploadValue("exhausted", ExhaustedRays{});
}

// What consumers counted since the maps were made anew: in the last frame.
void Roma::reportExhausted(Commands& commands) {
    const std::vector<std::byte> bytes = commands.download("exhausted");
    ExhaustedRays counted;
    KESTREL_CHECK_EQ(bytes.size(), sizeof(counted));
    std::memcpy(&counted, bytes.data(), sizeof(counted));
    if (counted.begun != ExhaustedRays{}.begun) return; // a new buffer
    commands.report("rays", counted.rays);
    commands.report("exhausted rays", counted.exhausted);
}

} // namespace kestrel
