#include "occupancy_trace.h"
#include "execute/commands.h"
#include "execute/exhausted_rays.h"
#include "graph/many_rays.h"
#include "grid.h"
#include "shared/occupancy_bricks.h"
#include "tracing.h"
#include <algorithm>
#include <array>
#include <bit>
#include <fmt/format.h>

namespace kestrel {
namespace {

// Columns a side where the hierarchy ends.
constexpr int topColumns = 4;

int topLevel(int resolution) {
    return std::countr_zero(static_cast<unsigned>(resolution)) -
           std::countr_zero(static_cast<unsigned>(topColumns));
}

Desc columnsDesc(int resolution, int levels) {
    const int words = resolution / 32;
    const auto columns = static_cast<std::uint64_t>(shared::occupancyLevelStart(levels, resolution));
    return Desc::buffer(columns * static_cast<std::uint64_t>(words) * 4, columnFormat(words));
}

} // namespace

PassType OccupancyTrace::type() {
    return Describe<OccupancyTrace>("OccupancyTrace",
                                    "Walks through an occupancy map: by bricks, 3D or 2D DDA")
        .input("occupancy", PortKind::Buffer, "Occupancy map")
        .carries(content::elements("OccupancyWord"))
        .input("grid", PortKind::Buffer, "Where its cells lie")
        .carries(content::elements("OccupancyGrid"))
        .output("tracer", PortKind::Tracer, "Traces the exact direction through the map")
        .internal("columns", PortKind::Buffer, "The map with each column's words together, level by level")
        .internal("bricks", PortKind::Buffer,
                  "The map in bricks of 2 x 2 x 2 cells (shared/occupancy_bricks.h)")
        .internal("cubes", PortKind::Buffer, "Which cubes of bricks hold anything, by size and direction")
        .internal("settings", PortKind::Buffer, "Where rays begin (shared/occupancy.h)")
        .internal("exhausted", PortKind::Buffer, "Rays traced, and those that ran out of iterations")
        .choice("method", &OccupancyTrace::method, {"dda_3d", "dda_2d", "bricks"},
                "From cell to cell; from column to column, testing many cells of one at once; or from brick "
                "of 2 x 2 x "
                "2 cells to brick, over empty cubes of them at once")
        .flag("mips", &OccupancyTrace::mips,
              "Column by column over a hierarchy of unions of 2 x 2 columns, leaving empty ones at once")
        .number("iterations", &OccupancyTrace::iterations, 1, 2048, "steps",
                "How many cells or columns, of any level, a ray may visit; then it counts as unoccluded")
        .number("offset", &OccupancyTrace::offset, 0, 8, "cells",
                "How far ray origins are moved off the surface, along its normal")
        .number("skip", &OccupancyTrace::skip, 0, 8, "cells",
                "How far rays from a surface go before anything counts")
        .flag("count_exhausted", &OccupancyTrace::countExhausted,
              "Counts the rays that ran out of iterations and reports them with the next frame");
}

Declaration OccupancyTrace::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const std::optional<int> resolution = mapResolution(inputs, declaration);
    if (!resolution) return declaration;
    const Bits many = method == TraceMethod::Bricks ? provides::ManyRays : 0;
    declaration.outputs = {{.port = "tracer", .desc = Desc::module(provides::Approximate | many)},
                           {.port = "settings", .desc = Desc::buffer(sizeof(shared::OccupancySettings))}};
    if (!demand.reads("tracer")) return declaration;

    Module tracer{.port = "tracer",
                  .shader = "occupancy/occupancy_trace.glsl",
                  .defines = columnDefines(*resolution),
                  .uses = {{.port = "grid", .access = Access::Uniform},
                           {.port = "settings", .access = Access::Uniform}}};
    tracer.defines.emplace("ITERATIONS", std::to_string(iterations));
    Step settings{.name = "settings",
                  .run = &OccupancyTrace::uploadSettings,
                  .uses = {{.port = "settings", .access = Access::Copy, .write = true}},
                  .group = "generation"};
    if (inputs["occupancy"].constant == glm::vec4(0)) {
        tracer.defines["EMPTY"] = "1";
        declaration.leftOut.push_back({"walking", "the occupancy map is empty"});
        declaration.steps = {settings};
    } else {
        if (countExhausted) exhaustion::declare(declaration, tracer, settings);
        declaration.steps.push_back(settings);
        if (method == TraceMethod::Dda2d && mips) {
            declareColumns(world, *resolution, declaration, tracer);
        } else if (method == TraceMethod::Bricks) {
            declareBricks(world, inputs["occupancy"].desc, *resolution, declaration, tracer);
        } else {
            tracer.defines["METHOD"] = method == TraceMethod::Dda3d ? "0" : "1";
            const bool image = fitsTexels(inputs["occupancy"].desc, world.capabilities);
            if (!image) tracer.defines["MAP_STORAGE"] = "1";
            tracer.uses.push_back({.port = "occupancy", .access = image ? Access::Image : Access::Storage});
            if (mips) declaration.leftOut.push_back({"hierarchy", "the walk goes from cell to cell"});
        }
    }
    declaration.modules.push_back(std::move(tracer));
    return declaration;
}

void OccupancyTrace::declareColumns(const World& world, int resolution, Declaration& declaration,
                                    Module& tracer) const {
    const int top = topLevel(resolution);
    const auto n = static_cast<std::uint32_t>(resolution);
    const Desc desc = columnsDesc(resolution, top + 1);
    tracer.defines["METHOD"] = "2";
    tracer.defines["TOP_LEVEL"] = std::to_string(top);
    const bool image = fitsTexels(desc, world.capabilities);
    if (!image) tracer.defines["MAP_STORAGE"] = "1";
    tracer.uses.push_back({.port = "columns", .access = image ? Access::Image : Access::Storage});
    declaration.outputs.push_back({.port = "columns", .desc = desc});
    Step columns{.name = "columns",
                 .run = [n](Commands& commands) { commands.dispatchOver(n, n); },
                 .shaders = {"occupancy/columns.comp"},
                 .defines = columnDefines(resolution),
                 .uses = {{.port = "columns", .access = Access::Storage, .write = true}},
                 .group = "generation"};
    Step coarser = columns;
    coarser.defines.emplace("COARSER", "1");
    columns.uses.push_back({.port = "occupancy", .access = Access::Storage});
    declaration.steps.push_back(std::move(columns));
    for (int level = 1; level <= top; ++level) {
        coarser.name = fmt::format("level{}", level);
        coarser.run = [n, level](Commands& commands) {
            commands.set("level", level);
            commands.dispatchOver(n >> level, n >> level);
        };
        declaration.steps.push_back(coarser);
    }
}

void OccupancyTrace::declareBricks(const World& world, const Desc& map, int resolution,
                                   Declaration& declaration, Module& tracer) {
    const int across = resolution / 2;
    const auto n = static_cast<std::uint32_t>(across);
    const auto rowWords = static_cast<std::uint32_t>((across + 31) / 32);
    // Until a cube spans the map.
    const int codes = std::min(shared::brickCodes, std::countr_zero(n) + 1);
    const Desc bricks = Desc::buffer(std::uint64_t{4} * n * n * n, Format::R32UI);
    const Desc cubes = Desc::buffer(
        std::uint64_t{4} * rowWords * n * n * (1 + 8 * static_cast<std::uint64_t>(codes - 1)), Format::R32UI);
    const bool image = fitsTexels(bricks, world.capabilities);
    tracer.defines["METHOD"] = "3";
    tracer.defines["BRICK_BITS"] = std::to_string(std::countr_zero(n));
    if (!image) tracer.defines["MAP_STORAGE"] = "1";
    tracer.uses.push_back({.port = "bricks", .access = image ? Access::Image : Access::Storage});
    declaration.outputs.push_back({.port = "bricks", .desc = bricks});
    declaration.outputs.push_back({.port = "cubes", .desc = cubes});

    Step pack{.name = "pack",
              .run = [=](Commands& commands) { commands.dispatchOver(rowWords * n * n); },
              .shaders = {"occupancy/bricks.comp"},
              .defines = {{"RESOLUTION", std::to_string(resolution)},
                          {"BRICKS", std::to_string(across)},
                          {"CODES", std::to_string(codes)}},
              .group = "generation"};
    Step grow = pack;
    grow.name = "cubes";
    grow.run = [](Commands& commands) { commands.dispatch(8); };
    grow.defines.emplace("CUBES", "1");
    grow.uses = {{.port = "cubes", .access = Access::Image, .write = true}};
    const bool texels = fitsTexels(map, world.capabilities);
    if (!texels) pack.defines.emplace("BASE_STORAGE", "1");
    pack.uses = {{.port = "occupancy", .access = texels ? Access::Image : Access::Storage}};
    Step occupied = pack;
    occupied.name = "occupied";
    occupied.defines.emplace("OCCUPIED", "1");
    occupied.uses.push_back({.port = "cubes", .access = Access::Storage, .write = true});
    pack.uses.push_back({.port = "cubes", .access = Access::Image});
    pack.uses.push_back({.port = "bricks", .access = Access::Storage, .write = true});
    for (Step& step : std::array{std::move(occupied), std::move(grow), std::move(pack)})
        declaration.steps.push_back(std::move(step));
}

void OccupancyTrace::uploadSettings(Commands& commands) const {
    commands.uploadValue("settings", shared::OccupancySettings{offset, skip, 0, 0});
    if (commands.uses("exhausted")) exhaustion::clear(commands);
}

} // namespace kestrel
