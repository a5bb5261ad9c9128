#include "roma.h"
#include "aligned_maps.h"
#include "execute/commands.h"
#include "execute/exhausted_rays.h"
#include "grid.h"
#include "tracing.h"

namespace kestrel {

PassType Roma::type() {
    return Describe<Roma>("Roma",
                          "Ray-aligned occupancy map array: an occupancy map rotated towards many directions")
        .input("occupancy", PortKind::Buffer, "Base occupancy map")
        .carries(content::elements("OccupancyWord"))
        .input("grid", PortKind::Buffer, "Where its cells lie")
        .carries(content::elements("OccupancyGrid"))
        .output("tracer", PortKind::Tracer,
                "Traces through the rotated maps, snapping where the consumer bears it")
        .internal("maps", PortKind::Buffer,
                  "The rotated maps, columns of words along each candidate direction")
        .internal("directions", PortKind::Buffer, "The candidate directions and their strata")
        .internal("cells", PortKind::Buffer, "The occupied cells of the base map")
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
        .choice(
            "rotation", &Roma::rotation, {"automatic", "gather"},
            "How maps are made: by visiting all of their cells, or from the occupied cells alone where these "
            "are few")
        .flag("count_exhausted", &Roma::countExhausted,
              "Counts the rays that ran out of iterations and reports them with the next frame");
}

Declaration Roma::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const std::optional<int> resolution = mapResolution(inputs, declaration);
    if (!resolution) return declaration;
    const Desc& base = inputs["occupancy"].desc;
    const AlignedMaps maps = alignedMaps(*resolution, angular, 1, world.capabilities, declaration);
    if (!declaration.problems.empty()) return declaration;
    declaration.outputs = {{.port = "tracer", .desc = Desc::module(provides::Snaps | provides::Approximate)}};
    if (!demand.reads("tracer")) return declaration;

    declaration.outputs.push_back({.port = "directions", .desc = maps.directionsDesc()});
    Module tracer{.port = "tracer",
                  .shader = "occupancy/roma.glsl",
                  .defines = maps.defines(),
                  .uses = {{.port = "grid", .access = Access::Uniform},
                           {.port = "directions", .access = Access::Image}}};
    tracer.defines["ANGULAR"] = std::to_string(angular);
    tracer.defines["ITERATIONS"] = std::to_string(iterations);
    Step candidates{.name = "candidates",
                    .run = &Roma::upload,
                    .uses = {{.port = "directions", .access = Access::Copy, .write = true}},
                    .group = "generation"};

    const bool empty = inputs["occupancy"].constant == glm::vec4(0);
    if (empty) {
        tracer.defines["EMPTY"] = "1";
        declaration.leftOut.push_back({"rotated maps", "the occupancy map is empty"});
        declaration.steps = {candidates};
    } else {
        addMapUses(maps, world.capabilities, tracer);
        // Renewed in turn: those of earlier frames are traced on.
        const bool inTurn = resample && refresh > 0 && refresh < maps.directions;
        Output rotated{.port = "maps", .desc = maps.desc, .keeps = inTurn};
        if (rotation == RotationMethod::Automatic && !inTurn) rotated.clear = glm::vec4(0);
        declaration.outputs.push_back(rotated);
        if (refresh > 0 && !resample)
            declaration.leftOut.push_back({"renewing maps in turn", "the candidates stay as they are"});
        declaration.outputs.push_back({.port = "rotations", .desc = maps.rotationsDesc()});
        candidates.uses.push_back({.port = "rotations", .access = Access::Copy, .write = true});
        if (countExhausted) exhaustion::declare(declaration, tracer, candidates);
        declaration.steps.push_back(candidates);
        if (rotation == RotationMethod::Automatic) {
            // Kept, so that a base map that stays as it is is listed once.
            declaration.outputs.push_back({.port = "cells", .desc = occupiedCellsDesc(maps), .keeps = true});
            declaration.steps.back().uses.push_back({.port = "cells", .access = Access::Copy, .write = true});
        }
        for (Step& step : rotationSteps(maps, base, inTurn, world.capabilities))
            declaration.steps.push_back(std::move(step));
    }
    declaration.modules.push_back(std::move(tracer));
    if (resample) declaration.depends = Causes::Frame;
    return declaration;
}

std::vector<Step> Roma::rotationSteps(const AlignedMaps& maps, const Desc& base, bool inTurn,
                                      const Capabilities& capabilities) const {
    if (rotation == RotationMethod::Gather) {
        Step rotate = rotateStep(maps, base, inTurn, capabilities);
        rotate.run = {&Roma::rotate, maps, inTurn};
        return {std::move(rotate)};
    }
    ScatterSteps steps = scatterSteps(maps, base, inTurn, capabilities);
    steps.list.run = {&Roma::list, maps.resolution};
    steps.choose.run = &Roma::choose;
    steps.blank.run = {&Roma::rotateChosen, RotationPart::Blank, maps, inTurn};
    steps.scatter.run = {&Roma::rotateChosen, RotationPart::Scatter, maps, inTurn};
    steps.rotate.run = {&Roma::rotateChosen, RotationPart::Rotate, maps, inTurn};
    if (!inTurn) return {steps.list, steps.choose, steps.scatter, steps.rotate};
    return {steps.list, steps.choose, steps.blank, steps.scatter, steps.rotate};
}

void Roma::rotate(Commands& commands, const AlignedMaps& maps, bool inTurn) const {
    dispatchRotation(maps, renewal_, inTurn, commands);
}

void Roma::list(Commands& commands, int resolution) const {
    if (changed_) listOccupiedCells(resolution, commands);
}

void Roma::choose(Commands& commands) const {
    if (changed_ || renewal_.count != countBefore_) chooseRotation(renewal_, commands);
}

void Roma::rotateChosen(Commands& commands, RotationPart part, const AlignedMaps& maps, bool inTurn) const {
    dispatchChosen(part, maps, 0, inTurn ? &renewal_ : nullptr, commands);
}

void Roma::upload(Commands& commands) {
    changed_ = any(commands.causes() & ~Causes::Frame) ||
               any(commands.causes("occupancy") | commands.causes("grid"));
    const FrameInfo& frame = commands.frame();
    countBefore_ = renewal_.count;
    renewal_ =
        candidates_.draw(angular, resample ? refresh : 0, changed_, resample ? frame.index : 0, frame.seed);
    uploadCandidates(candidates_, offset, skip, commands);
    if (changed_ && commands.uses("cells")) clearOccupiedCells(0, 0, commands);
    if (commands.uses("exhausted")) exhaustion::clear(commands);
}

} // namespace kestrel
