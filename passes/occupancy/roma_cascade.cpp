#include "roma_cascade.h"
#include "aligned_maps.h"
#include "exact_marking.h"
#include "execute/commands.h"
#include "execute/exhausted_rays.h"
#include "grid.h"
#include "tracing.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace kestrel {
namespace {

// Where the levels lie, finest first.
std::vector<shared::OccupancyGrid> cascadeGrids(const SceneFacts& facts, const glm::vec3& camera, int levels,
                                                float ratio, int resolution) {
    std::vector<shared::OccupancyGrid> grids(static_cast<size_t>(levels));
    grids.back() = occupancyGrid(facts.sphere, facts.bounds, resolution);
    for (size_t i = grids.size() - 1; i-- > 0;) {
        shared::OccupancyGrid& grid = grids[i] = grids[i + 1];
        grid.cellSize *= ratio;
        grid.inverseCellSize = 1 / grid.cellSize;
        grid.centre = glm::round(camera * grid.inverseCellSize) * grid.cellSize;
        boundOccupied(grid, facts.bounds);
    }
    return grids;
}

bool sameGrid(const shared::OccupancyGrid& a, const shared::OccupancyGrid& b) {
    return a.centre == b.centre && a.cellSize == b.cellSize && a.resolution == b.resolution;
}

} // namespace

PassType RomaCascade::type() {
    return Describe<RomaCascade>("RomaCascade",
                                 "Ray-aligned occupancy map arrays nested around the camera: near detail in "
                                 "scenes of any extent")
        .output("tracer", PortKind::Tracer,
                "Traces through the finest maps that reach, snapping where the consumer bears it")
        .internal("occupancy", PortKind::Buffer, "The base maps of all levels, finest first")
        .internal("grids", PortKind::Buffer, "Where their cells lie")
        .internal("large", PortKind::Buffer, "Triangles over many cells, and the work groups that mark them")
        .internal("maps", PortKind::Buffer, "The rotated maps, level by level")
        .internal("cells", PortKind::Buffer, "The occupied cells of the base maps")
        .internal("directions", PortKind::Buffer, "The candidate directions and their strata")
        .internal("rotations", PortKind::Buffer, "The rotated maps' axes in fixed point")
        .internal("exhausted", PortKind::Buffer,
                  "Rays traced without snapping, and those that ran out of iterations")
        .number("levels", &RomaCascade::levels, 2, 4, "maps", "How many maps are nested")
        .number("ratio", &RomaCascade::ratio, 0.1, 0.9, "", "Extent of a level over that of the next coarser")
        .number("resolution", &RomaCascade::resolution, 32, 256, "cells",
                "Cells along an edge of each: 32, 64, 128 or 256")
        .number("angular", &RomaCascade::angular, 2, 16, "strata per axis",
                "Angular resolution: its square is the number of rotated maps a level")
        .number(
            "iterations", &RomaCascade::iterations, 1, 256, "columns",
            "How many columns of a level a ray that is not snapped may cross; then it counts as unoccluded "
            "there")
        .number("offset", &RomaCascade::offset, 0, 8, "cells",
                "How far ray origins are moved off the surface, along its normal")
        .number("skip", &RomaCascade::skip, 0, 8, "cells",
                "How far rays from a surface go before anything counts")
        .flag("resample", &RomaCascade::resample,
              "New candidate directions every frame; otherwise those of frame 0")
        .number("refresh", &RomaCascade::refresh, 0, 256, "maps",
                "How many maps of a level a frame renews, in turn, while the level stays as it is; 0: all")
        .choice(
            "rotation", &RomaCascade::rotation, {"automatic", "gather"},
            "How maps are made: by visiting all of their cells, or from the occupied cells alone where these "
            "are few")
        .flag("count_exhausted", &RomaCascade::countExhausted,
              "Counts the rays that ran out of iterations and reports them with the next frame");
}

Declaration RomaCascade::declare(const World& world, const Inputs&, const Demand& demand) const {
    Declaration declaration;
    if (!isOccupancyResolution(resolution)) {
        declaration.problems.push_back(
            {"resolution", fmt::format("must be 32, 64, 128 or 256, not {}", resolution)});
        return declaration;
    }
    const AlignedMaps maps = alignedMaps(resolution, angular, levels, world.capabilities, declaration);
    if (!declaration.problems.empty()) return declaration;
    declaration.outputs = {{.port = "tracer", .desc = Desc::module(provides::Snaps | provides::Approximate)}};
    if (!demand.reads("tracer")) return declaration;

    const auto count = static_cast<std::uint64_t>(levels);
    declaration.outputs.push_back(
        {.port = "grids", .desc = Desc::buffer(sizeof(shared::OccupancyGrid) * count)});
    declaration.outputs.push_back({.port = "directions", .desc = maps.directionsDesc()});
    Module tracer{.port = "tracer",
                  .shader = "occupancy/roma_cascade.glsl",
                  .defines = maps.defines(),
                  .uses = {{.port = "grids", .access = Access::Uniform},
                           {.port = "directions", .access = Access::Image}}};
    tracer.defines["LEVELS"] = std::to_string(levels);
    tracer.defines["ANGULAR"] = std::to_string(angular);
    tracer.defines["ITERATIONS"] = std::to_string(iterations);
    Step begin{.name = "begin",
               .run = &RomaCascade::begin,
               .uses = {{.port = "grids", .access = Access::Copy, .write = true},
                        {.port = "directions", .access = Access::Copy, .write = true}},
               .group = "generation"};
    if (world.facts.triangles == 0 || !hasExtent(world.facts.sphere, resolution)) {
        tracer.defines["EMPTY"] = "1";
        declaration.leftOut.push_back({"maps", "the scene has no triangle with an extent"});
        declaration.steps = {begin};
    } else {
        declareMaps(world, declaration, tracer, begin);
    }
    declaration.modules.push_back(std::move(tracer));
    declaration.depends |= Causes::Camera | Causes::Cut;
    if (resample) declaration.depends |= Causes::Frame;
    return declaration;
}

// The steps: "begin", then "clear", "triangles", "large_triangles" and those of the rotation of each level,
// with its number.
void RomaCascade::declareMaps(const World& world, Declaration& declaration, Module& tracer,
                              Step& begin) const {
    const AlignedMaps maps = alignedMaps(resolution, angular, levels, world.capabilities, declaration);
    const Desc occupancy =
        Desc::buffer(occupancyBytes(resolution) * static_cast<std::uint64_t>(levels), Format::R32UI);
    // Levels that stay as they are keep their cells, and maps that are not renewed their bits.
    declaration.outputs.push_back({.port = "occupancy", .desc = occupancy, .keeps = true});
    declaration.outputs.push_back({.port = "maps", .desc = maps.desc, .keeps = true});
    declaration.outputs.push_back({.port = "rotations", .desc = maps.rotationsDesc()});
    declaration.outputs.push_back({.port = "large", .desc = largeTrianglesDesc(world)});
    addMapUses(maps, world.capabilities, tracer);
    begin.uses.push_back({.port = "rotations", .access = Access::Copy, .write = true});
    const bool lists = rotation == RotationMethod::Automatic;
    if (lists) {
        declaration.outputs.push_back({.port = "cells", .desc = occupiedCellsDesc(maps), .keeps = true});
        begin.uses.push_back({.port = "cells", .access = Access::Copy, .write = true});
    }
    if (countExhausted) exhaustion::declare(declaration, tracer, begin);
    declaration.steps.push_back(begin);

    const bool inTurn = resample && refresh > 0 && refresh < maps.directions;
    if (refresh > 0 && !resample)
        declaration.leftOut.push_back({"renewing maps in turn", "the candidates stay as they are"});
    const Step clear{.name = "clear",
                     .uses = {{.port = "occupancy", .access = Access::Copy, .write = true},
                              {.port = "large", .access = Access::Copy, .write = true}},
                     .group = "generation"};
    const std::vector<Step> marking = exactSteps(world, resolution);
    const Step rotate = rotateStep(maps, occupancy, inTurn, world.capabilities);
    const ScatterSteps scatter = scatterSteps(maps, occupancy, inTurn, world.capabilities);
    for (int level = 0; level < levels; ++level) {
        const auto add = [&](Step step, StepRun run) {
            step.name += fmt::format("_{}", level);
            step.run = std::move(run);
            declaration.steps.push_back(std::move(step));
        };
        add(clear, {&RomaCascade::clearLevel, level});
        for (Step step : marking) {
            step.defines["LEVELS"] = std::to_string(levels);
            step.uses.front().port = "grids";
            const StepRun run = step.run;
            add(std::move(step), {&RomaCascade::markLevel, level, run});
        }
        if (!lists) {
            add(rotate, {&RomaCascade::rotateLevel, level, maps, inTurn});
            continue;
        }
        add(scatter.list, {&RomaCascade::listLevel, level});
        add(scatter.choose, {&RomaCascade::chooseLevel, level});
        add(scatter.blank, {&RomaCascade::rotateChosen, level, RotationPart::Blank, maps, inTurn});
        add(scatter.scatter, {&RomaCascade::rotateChosen, level, RotationPart::Scatter, maps, inTurn});
        add(scatter.rotate, {&RomaCascade::rotateChosen, level, RotationPart::Rotate, maps, inTurn});
    }
    declaration.depends |= Causes::Geometry | Causes::Transforms;
    if (world.facts.hasMasked)
        declaration.depends |= Causes::Materials;
    else
        declaration.leftOut.push_back({"alpha test", "no material is masked or blended"});
}

void RomaCascade::begin(Commands& commands) {
    const FrameInfo& frame = commands.frame();
    countBefore_.resize(static_cast<size_t>(levels));
    for (size_t i = 0; i < stale_.size() && i < countBefore_.size(); ++i)
        countBefore_[i] = renewalOf(static_cast<int>(i)).count;
    const bool changed = any(commands.causes() & ~(Causes::Frame | Causes::Camera | Causes::Cut));
    std::vector<shared::OccupancyGrid> grids =
        cascadeGrids(commands.facts(), frame.cameraState.position, levels, ratio, resolution);
    stale_.assign(grids.size(), true);
    if (!changed && grids_.size() == grids.size())
        for (size_t i = 0; i < grids.size(); ++i) stale_[i] = !sameGrid(grids[i], grids_[i]);
    grids_ = std::move(grids);
    commands.upload("grids", grids_);
    renewal_ =
        candidates_.draw(angular, resample ? refresh : 0, changed, resample ? frame.index : 0, frame.seed);
    uploadCandidates(candidates_, offset, skip, commands);
    if (commands.uses("cells"))
        for (int level = 0; level < levels; ++level)
            if (isStale(level)) clearOccupiedCells(resolution, level, commands);
    if (commands.uses("exhausted")) exhaustion::clear(commands);
    commands.report("levels marked", static_cast<double>(std::count(stale_.begin(), stale_.end(), true)));
}

void RomaCascade::clearLevel(Commands& commands, int level) const {
    if (!isStale(level)) return;
    const std::uint64_t bytes = occupancyBytes(resolution);
    commands.upload("occupancy", std::vector<std::uint32_t>(bytes / 4),
                    bytes * static_cast<std::uint64_t>(level));
    commands.uploadValue("large", glm::uvec4(0));
}

void RomaCascade::markLevel(Commands& commands, int level, const StepRun& marking) {
    commands.set("level", level);
    if (isStale(level)) marking(*this, commands);
}

Renewal RomaCascade::renewalOf(int level) const {
    if (isStale(level)) return {0, angular * angular};
    return resample ? renewal_ : Renewal{};
}

void RomaCascade::rotateLevel(Commands& commands, int level, const AlignedMaps& maps, bool inTurn) const {
    commands.set("level", level);
    if (const Renewal renewal = renewalOf(level); renewal.count > 0)
        dispatchRotation(maps, renewal, inTurn, commands);
}

void RomaCascade::listLevel(Commands& commands, int level) const {
    commands.set("level", level);
    if (isStale(level)) listOccupiedCells(resolution, commands);
}

void RomaCascade::chooseLevel(Commands& commands, int level) const {
    commands.set("level", level);
    const Renewal renewal = renewalOf(level);
    if (isStale(level) || renewal.count != countBefore_.at(static_cast<size_t>(level)))
        chooseRotation(renewal, commands);
}

void RomaCascade::rotateChosen(Commands& commands, int level, RotationPart part, const AlignedMaps& maps,
                               bool inTurn) const {
    commands.set("level", level);
    if (const Renewal renewal = renewalOf(level); renewal.count > 0)
        dispatchChosen(part, maps, level, inTurn ? &renewal : nullptr, commands);
}

} // namespace kestrel
