#include "aligned_maps.h"
#include "execute/commands.h"
#include "grid.h"
#include "shared/occupancy.h"
#include "tracing.h"
#include <bit>
#include <fmt/format.h>

namespace kestrel {

Defines AlignedMaps::defines() const {
    return {{"RESOLUTION", std::to_string(resolution)},
            {"WORDS", std::to_string(words())},
            {"DIRECTIONS", std::to_string(directions)}};
}

Desc AlignedMaps::directionsDesc() const {
    return Desc::buffer(sizeof(shared::OccupancySettings) +
                        sizeof(shared::RomaDirection) * static_cast<std::uint64_t>(directions),
                        Format::RGBA32F);
}

Desc AlignedMaps::rotationsDesc() const {
    return Desc::buffer(sizeof(shared::RomaRotation) * static_cast<std::uint64_t>(directions));
}

AlignedMaps alignedMaps(int resolution, int angular, int levels, const Capabilities& capabilities,
                        Declaration& declaration) {
    AlignedMaps maps{resolution, angular * angular, levels, {}};
    const int count = maps.directions * levels;
    maps.desc = Desc::buffer(occupancyBytes(resolution) * static_cast<std::uint64_t>(count),
                             columnFormat(maps.words()));
    const std::int64_t limit = capabilities.maxStorageBlockBytes;
    if (maps.desc.bytes > static_cast<std::uint64_t>(limit))
        declaration.problems.push_back(
            {"tracer",
             fmt::format("{} maps of {} cells an edge need {} bytes in one storage block; the limit is {}",
                         count, resolution, maps.desc.bytes, limit)});
    return maps;
}

Step rotateStep(const AlignedMaps& maps, const Desc& occupancy, bool inTurn,
                const Capabilities& capabilities) {
    Step step{.name = "rotate",
              .shaders = {"occupancy/rotate.comp"},
              .defines = maps.defines(),
              .uses = {{.port = "occupancy", .access = Access::Image},
                       {.port = maps.levels > 1 ? "grids" : "grid", .access = Access::Uniform},
                       {.port = "rotations", .access = Access::Uniform},
                       {.port = "maps", .access = Access::Storage, .write = true}},
              .modules = {},
              .group = "generation"};
    step.defines["RESOLUTION_BITS"] =
        std::to_string(std::countr_zero(static_cast<unsigned>(maps.resolution)));
    if (inTurn) step.defines.emplace("IN_TURN", "1");
    if (maps.levels > 1) step.defines["LEVELS"] = std::to_string(maps.levels);
    if (!fitsTexels(occupancy, capabilities)) {
        step.defines.emplace("BASE_STORAGE", "1");
        step.uses.front().access = Access::Storage;
    }
    return step;
}

void dispatchRotation(const Step& step, const AlignedMaps& maps, const Renewal& renewal, Commands& commands) {
    if (step.defines.contains("IN_TURN")) {
        commands.set("firstPlace", renewal.first);
        commands.set("placeStride", renewalStride(maps.directions));
    }
    const auto n = static_cast<std::uint32_t>(maps.resolution);
    commands.dispatchOver(n, n, static_cast<std::uint32_t>(renewal.count));
}

void uploadCandidates(const Step& step, const Candidates& candidates, float offset, float skip,
                      Commands& commands) {
    commands.uploadValue("directions", shared::OccupancySettings{offset, skip, 0, 0});
    commands.upload("directions", candidates.strata(), sizeof(shared::OccupancySettings));
    if (!usesPort(step, "rotations")) return;
    std::vector<shared::RomaRotation> rotations;
    for (const shared::RomaDirection& stratum : candidates.strata())
        rotations.push_back(romaRotation(stratum.direction));
    commands.upload("rotations", rotations);
}

void addMapUses(const AlignedMaps& maps, const Capabilities& capabilities, Module& tracer) {
    const bool image = fitsTexels(maps.desc, capabilities);
    if (!image) tracer.defines["MAPS_STORAGE"] = "1";
    tracer.uses.push_back({.port = "maps", .access = image ? Access::Image : Access::Storage});
}

} // namespace kestrel
