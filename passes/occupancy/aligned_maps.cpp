#include "aligned_maps.h"
#include "execute/commands.h"
#include "grid.h"
#include "shared/occupancy.h"
#include "shared/occupied_cells.h"
#include "tracing.h"
#include <bit>
#include <cstddef>
#include <fmt/format.h>

namespace kestrel {

Defines AlignedMaps::defines() const {
    Defines defines = columnDefines(resolution);
    defines.emplace("DIRECTIONS", std::to_string(directions));
    return defines;
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
                         count, resolution, maps.desc.bytes, limit),
             true});
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

namespace {

// One cell in 32: more than are ever worth scattering (shaders/occupancy/occupied_cells.comp).
std::uint64_t listedCells(int resolution) { return 8 * occupancyBytes(resolution) / 32; }

std::uint64_t listBytes(int resolution) {
    return sizeof(shared::OccupiedCellsHeader) + 4 * listedCells(resolution);
}

} // namespace

Desc occupiedCellsDesc(const AlignedMaps& maps) {
    return Desc::buffer(listBytes(maps.resolution) * static_cast<std::uint64_t>(maps.levels));
}

ScatterSteps scatterSteps(const AlignedMaps& maps, const Desc& occupancy, bool inTurn,
                          const Capabilities& capabilities) {
    Step rotate = rotateStep(maps, occupancy, inTurn, capabilities);
    rotate.defines["CELLS"] = std::to_string(listedCells(maps.resolution));
    const Use base = rotate.uses[0], grid = rotate.uses[1];
    const Use cells{.port = "cells", .access = Access::Storage};
    const Use written{.port = "cells", .access = Access::Storage, .write = true};
    const Use groups{.port = "cells", .access = Access::Indirect};
    const Use turned{.port = "rotations", .access = Access::Uniform};
    const Use rotated{.port = "maps", .access = Access::Storage, .write = true};

    Step list = rotate;
    list.name = "list";
    list.shaders = {"occupancy/occupied_cells.comp"};
    list.uses = {base, written};
    Step choose = list;
    choose.name = "choose";
    choose.defines.emplace("CHOOSE", "1");
    choose.uses = {grid, written};
    Step scatter = rotate;
    scatter.name = "scatter";
    scatter.shaders = {"occupancy/scatter.comp"};
    scatter.uses = {turned, cells, rotated, groups};
    Step blank = scatter;
    blank.name = "blank";
    blank.defines.emplace("BLANK", "1");
    blank.uses = {rotated, groups};
    rotate.uses.push_back(groups);
    return {std::move(list), std::move(choose), std::move(blank), std::move(scatter), std::move(rotate)};
}

void clearOccupiedCells(int resolution, int level, Commands& commands) {
    commands.upload("cells", std::vector{shared::OccupiedCellsHeader{}},
                    listBytes(resolution) * static_cast<std::uint64_t>(level));
}

namespace {

void setTurn(const AlignedMaps& maps, const Renewal& renewal, Commands& commands) {
    commands.set("firstPlace", renewal.first);
    commands.set("placeStride", renewalStride(maps.directions));
}

} // namespace

void listOccupiedCells(int resolution, Commands& commands) {
    commands.dispatchOver(static_cast<std::uint32_t>(occupancyBytes(resolution) / 4));
}

void chooseRotation(const Renewal& renewal, Commands& commands) {
    commands.set("mapCount", static_cast<std::uint32_t>(renewal.count));
    commands.dispatch(1);
}

void dispatchChosen(RotationPart part, const AlignedMaps& maps, int level, const Renewal* renewal,
                    Commands& commands) {
    using Header = shared::OccupiedCellsHeader;
    if (renewal != nullptr) setTurn(maps, *renewal, commands);
    const std::uint64_t groups = part == RotationPart::Blank     ? offsetof(Header, blank)
                                 : part == RotationPart::Scatter ? offsetof(Header, scatter)
                                                                 : offsetof(Header, rotate);
    commands.dispatchIndirect("cells",
                              groups + listBytes(maps.resolution) * static_cast<std::uint64_t>(level));
}

void dispatchRotation(const AlignedMaps& maps, const Renewal& renewal, bool inTurn, Commands& commands) {
    if (inTurn) setTurn(maps, renewal, commands);
    const auto n = static_cast<std::uint32_t>(maps.resolution);
    commands.dispatchOver(n, n, static_cast<std::uint32_t>(renewal.count));
}

void uploadCandidates(const Candidates& candidates, float offset, float skip, Commands& commands) {
    commands.uploadValue("directions", shared::OccupancySettings{offset, skip, 0, 0});
    commands.upload("directions", candidates.strata(), sizeof(shared::OccupancySettings));
    if (!commands.uses("rotations")) return;
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
