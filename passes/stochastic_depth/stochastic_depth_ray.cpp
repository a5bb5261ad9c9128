#include "stochastic_depth_ray.h"
#include "depth_map.h"
#include "execute/commands.h"
#include "shared/work_list.h"
#include <cstddef>

namespace kestrel {

PassType StochasticDepthRay::type() {
    return Describe<StochasticDepthRay>("StochasticDepthRay",
                                        "Depths behind the first surface by one ray a texel, a few of them "
                                        "kept at random: a stochastic depth map where a mask asks for it")
        .input("view_depth", PortKind::Texture, "Distance of the first surface along the view axis")
        .carries(content::viewDepth)
        .input("hits", PortKind::Hits, "Who enumerates what rays meet")
        .optionalInput("sd_mask", PortKind::Texture,
                       "1 where a texel is asked for; read without `interval`. Without a mask every texel is")
        .carries({.channels = 1})
        .optionalInput("ray_min", PortKind::Texture, "Where each texel's ray begins, as float bits")
        .carries({.channels = 1})
        .sameExtentAs("sd_mask")
        .optionalInput("ray_max", PortKind::Texture, "And where it ends; 0 where no texel is asked for")
        .carries({.channels = 1})
        .sameExtentAs("sd_mask")
        .output("layers", PortKind::Layers, "The depths kept, in no order but a k-buffer's")
        .output("depths", PortKind::Texture,
                "The same as images: view depth, four slots an image; 3e38 where a slot is empty")
        .carries({.space = Space::View})
        .internal("texels", PortKind::Buffer, "The texels to trace, as a list (shared/work_list.h)")
        .number("layers_per_texel", &StochasticDepthRay::layers, 1, 16, "slots",
                "Depths that a texel keeps at most (N)")
        .choice("collection", &StochasticDepthRay::collection, {"reservoir", "coverage_mask", "k_buffer"},
                "Which hits stay: a random sample; per slot the nearest of a random subset; the nearest")
        .number("max_count", &StochasticDepthRay::maxCount, 0, 4096, "hits",
                "From so many on each hit shortens the ray to itself (MAX_COUNT); 0: none does")
        .flag("z_cull", &StochasticDepthRay::zCull,
              "A reservoir's hit replaces farther ones only, as in Listing 1: where hits come front to back, "
              "as of Bvh, the first ones stay")
        .flag("interval", &StochasticDepthRay::interval,
              "Looks only between the distances that the samples need")
        .flag("jitter", &StochasticDepthRay::jitter,
              "Takes the samples of 4 x 4 texels at different places within them")
        .number("divisor", &StochasticDepthRay::divisor, 1, 16, "",
                "Of the frame's resolution per axis, where no mask gives the map's")
        .number("guard", &StochasticDepthRay::guard, 0, 4096, "pixels",
                "Guard band, where no mask gives the map's; that of the depth at least");
}

Declaration StochasticDepthRay::declare(const World& world, const Inputs& inputs,
                                        const Demand& demand) const {
    Declaration declaration;
    const MapShape map = mapShape(world, inputs, interval, divisor, guard, declaration.problems);
    const bool bounded = interval && !map.whole;
    const Desc depths = depthMapDesc(layers, map.extent, map.view);

    Output images{.port = "depths", .desc = depths};
    const bool nothing = world.facts.triangles == 0 || map.empty;
    if (nothing)
        images.constant = glm::vec4(3.0e38f);
    else if (!map.whole)
        images.clear = glm::vec4(3.0e38f); // noLayer of lib/layers.glsl
    declaration.outputs.push_back(std::move(images));
    if (demand.reads("layers")) {
        const DepthLayers told{
            .count = layers, .linear = true, .ordered = collection == RayCollection::KBuffer || layers == 1};
        declaration.outputs.push_back({.port = "layers", .desc = Desc::layersModule(told, map.view)});
        declaration.modules.push_back(depthMapModule(depths, layers, jitter));
    }
    if (nothing) {
        declaration.leftOut.push_back({"tracing", "no texel is asked for"});
        return declaration;
    }
    if (!world.facts.hasMasked)
        declaration.leftOut.push_back({"alpha test at hits", "no material is masked or blended"});

    if (!map.whole) {
        const std::uint64_t texels = std::uint64_t{map.extent.width} * map.extent.height;
        declaration.outputs.push_back({.port = "texels", .desc = texelListDesc(texels)});
        declaration.steps.push_back({.name = "clear_list",
                                     .run = &StochasticDepthRay::clearList,
                                     .uses = {{.port = "texels", .access = Access::Copy, .write = true}},
                                     .group = "generation"});
        Step list{.name = "list",
                  .run = &StochasticDepthRay::list,
                  .shaders = {"stochastic_depth/list.comp"},
                  .uses = {{.port = map.mask, .access = Access::Image},
                           {.port = "texels", .access = Access::Storage, .write = true}},
                  .group = "generation"};
        list.defines = {
            {"WANTED", map.mask}, {"WANTED_FORMAT", interval ? "r32ui" : "r8ui"}, {"LIST", "Texels"}};
        declaration.steps.push_back(std::move(list));
    }

    declaration.steps.push_back(traceStep(world,
                                          {.layers = layers,
                                           .collection = collection,
                                           .maxCount = maxCount,
                                           .zCull = zCull,
                                           .jitter = jitter,
                                           .intervalTexels = bounded ? 1 : 0,
                                           .wholeMap = map.whole},
                                          depths, &StochasticDepthRay::trace));
    declaration.depends = Causes::Properties;
    return declaration;
}

void StochasticDepthRay::clearList(Commands& commands) const {
    commands.uploadValue("texels", shared::WorkListHeader{0, 0, 0, 0, {0, 1, 1, 0}});
}

void StochasticDepthRay::list(Commands& commands) const {
    const Extent extent = commands.desc(interval ? "ray_max" : "sd_mask").extent;
    commands.dispatchOver((extent.width + 7) / 8, extent.height);
}

void StochasticDepthRay::trace(Commands& commands) const {
    if (commands.uses("texels")) {
        commands.dispatchIndirect("texels", offsetof(shared::WorkListHeader, groups));
        return;
    }
    const Extent map = commands.desc("depths").extent;
    commands.dispatchOver(map.width, map.height);
}

} // namespace kestrel
