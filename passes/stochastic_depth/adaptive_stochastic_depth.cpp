#include "adaptive_stochastic_depth.h"
#include "depth_map.h"
#include "execute/commands.h"
#include "shared/stochastic_depth.h"
#include "shared/work_list.h"
#include <cstddef>
#include <fmt/format.h>

namespace kestrel {

PassType AdaptiveStochasticDepth::type() {
    return Describe<AdaptiveStochasticDepth>(
               "AdaptiveStochasticDepth",
               "A stochastic depth map that is traced at four times the resolution per axis where edges or "
               "the density of samples ask for it")
        .input("coarse", PortKind::Layers, "The map of whose texels some are traced cell by cell")
        .input("sd_cells", PortKind::Texture,
               "Of the coarse map's size: the cells of each texel that samples fall into, a bit each")
        .carries({.channels = 1})
        .input("ray_min", PortKind::Texture, "Where each texel's rays begin, as float bits")
        .carries({.channels = 1})
        .sameExtentAs("sd_cells")
        .input("ray_max", PortKind::Texture, "And where they end")
        .carries({.channels = 1})
        .sameExtentAs("sd_cells")
        .input("view_depth", PortKind::Texture, "Distance of the first surface along the view axis")
        .carries(content::viewDepth)
        .input("hits", PortKind::Hits, "Who enumerates what rays meet")
        .output("layers", PortKind::Layers,
                "The depths kept: of a cell where it was traced, else of the texel")
        .output("chosen", PortKind::Texture, "Of each texel the cells that are traced, a bit each")
        .carries({.channels = 1})
        .internal("depths", PortKind::Texture,
                  "View depths of cells, four slots an image; only those that `chosen` names are written")
        .internal("texels", PortKind::Buffer, "The cells to trace, as a list (shared/work_list.h)")
        .flag("edges", &AdaptiveStochasticDepth::edges,
              "Texels beside an edge of the coarse map are traced cell by cell")
        .number("edge", &AdaptiveStochasticDepth::edge, 0, 1e9, "",
                "By how much the nearest depths of neighbours differ at an edge, relative to the smaller; a "
                "depth beside none is one; 0: all texels are beside one")
        .number("density", &AdaptiveStochasticDepth::density, 1, shared::depthCells + 1, "cells",
                "Texels are so, too, where samples fall into so many of their cells; 17: never")
        .choice("collection", &AdaptiveStochasticDepth::collection,
                {"reservoir", "coverage_mask", "k_buffer"},
                "Which hits stay: a random sample; per slot the nearest of a random subset; the nearest")
        .number("max_count", &AdaptiveStochasticDepth::maxCount, 0, 4096, "hits",
                "From so many on each hit shortens the ray to itself (MAX_COUNT); 0: none does")
        .flag("z_cull", &AdaptiveStochasticDepth::zCull,
              "A reservoir's hit replaces farther ones only, as in Listing 1: where hits come front to back, "
              "as of Bvh, the first ones stay")
        .flag("interval", &AdaptiveStochasticDepth::interval,
              "Looks only between the distances that the samples of the texel need");
}

Declaration AdaptiveStochasticDepth::declare(const World& world, const Inputs& inputs,
                                             const Demand& demand) const {
    Declaration declaration;
    const Desc& coarse = inputs["coarse"].desc;
    const Desc& cells = inputs["sd_cells"].desc;
    const View& map = cells.view;
    const bool nothing = world.facts.triangles == 0 || inputs["sd_cells"].constant == glm::vec4(0);
    if (coarse.view != map)
        declaration.problems.push_back({"coarse", "is no map of the size and view of sd_cells"});
    if (map.divisor % shared::depthCellsAcross != 0) {
        declaration.problems.push_back(
            {"sd_cells", fmt::format("has a divisor of {}, which is no multiple of {}", map.divisor,
                                     shared::depthCellsAcross)});
        return declaration;
    }
    if (demand.reads("layers") && nothing) {
        declaration.outputs.push_back({.port = "layers", .desc = coarse, .same = "coarse"});
    }
    Output chosen{.port = "chosen", .desc = Desc::texture2D(Format::R32UI, cells.extent, map)};
    (nothing ? chosen.constant : chosen.clear) = glm::vec4(0);
    declaration.outputs.push_back(std::move(chosen));
    if (nothing) {
        declaration.leftOut.push_back({"tracing", "no texel is asked for"});
        return declaration;
    }

    View fine = map;
    fine.divisor = map.divisor / shared::depthCellsAcross;
    const int layers = coarse.depthLayers.count;
    const Desc depths = depthMapDesc(layers, world.extentOf(fine), fine);
    declaration.outputs.push_back({.port = "depths", .desc = depths});
    declaration.outputs.push_back({.port = "texels",
                                   .desc = texelListDesc(std::uint64_t{cells.extent.width} *
                                                         cells.extent.height * shared::depthCells)});
    if (demand.reads("layers")) {
        DepthLayers told = coarse.depthLayers;
        told.ordered = told.ordered && (collection == RayCollection::KBuffer || layers == 1);
        declaration.outputs.push_back({.port = "layers", .desc = Desc::layersModule(told, map)});
        declaration.modules.push_back(
            {.port = "layers",
             .shader = "stochastic_depth/adaptive.glsl",
             .defines = {{"LAYERS", std::to_string(layers)},
                         {"DEPTHS_FORMAT", std::string(formatInfo(depths.format).name)}},
             .uses = {{.port = "depths", .access = Access::Image},
                      {.port = "chosen", .access = Access::Image}},
             .modules = {{"coarse", 0}}});
    }
    declaration.steps.push_back({.name = "clear_list",
                                 .run = &AdaptiveStochasticDepth::clearList,
                                 .uses = {{.port = "texels", .access = Access::Copy, .write = true}},
                                 .group = "generation"});
    declaration.steps.push_back({.name = "choose",
                                 .run = &AdaptiveStochasticDepth::choose,
                                 .shaders = {"stochastic_depth/choose.comp"},
                                 .uses = {{.port = "sd_cells", .access = Access::Image},
                                          {.port = "chosen", .access = Access::Image, .write = true},
                                          {.port = "texels", .access = Access::Storage, .write = true}},
                                 .modules = {{"coarse", 0}},
                                 .group = "generation"});
    declaration.steps.push_back(traceStep(world,
                                          {.layers = layers,
                                           .collection = collection,
                                           .maxCount = maxCount,
                                           .zCull = zCull,
                                           .jitter = false,
                                           .intervalTexels = interval ? shared::depthCellsAcross : 0},
                                          depths, &AdaptiveStochasticDepth::trace));
    declaration.depends = Causes::Properties;
    return declaration;
}

void AdaptiveStochasticDepth::clearList(Commands& commands) const {
    commands.uploadValue("texels", shared::WorkListHeader{0, 0, 0, 0, {0, 1, 1, 0}});
}

void AdaptiveStochasticDepth::choose(Commands& commands) const {
    commands.set("edge", edges ? edge : -1.0f);
    commands.set("density", density);
    commands.dispatchOver(commands.desc("sd_cells").extent);
}

void AdaptiveStochasticDepth::trace(Commands& commands) const {
    commands.dispatchIndirect("texels", offsetof(shared::WorkListHeader, groups));
}

} // namespace kestrel
