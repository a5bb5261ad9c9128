#include "stochastic_depth_raster.h"
#include "depth_map.h"
#include "draw/material_defines.h"
#include "execute/commands.h"

namespace kestrel {

PassType StochasticDepthRaster::type() {
    return Describe<StochasticDepthRaster>(
               "StochasticDepthRaster",
               "Depths behind the first surface by drawing the scene, a few of them kept at random: a "
               "stochastic depth map where a mask asks for it")
        .input("view_depth", PortKind::Texture, "Distance of the first surface along the view axis")
        .carries(content::viewDepth)
        .optionalInput("sd_mask", PortKind::Texture,
                       "1 where a texel is asked for; read without `interval`. Without a mask every texel is")
        .carries({.channels = 1})
        .optionalInput("ray_min", PortKind::Texture, "From which distance on each texel looks, as float bits")
        .carries({.channels = 1})
        .sameExtentAs("sd_mask")
        .optionalInput("ray_max", PortKind::Texture, "And up to which; 0 where no texel is asked for")
        .carries({.channels = 1})
        .sameExtentAs("sd_mask")
        .output("layers", PortKind::Layers, "The depths kept, in no order but a k-buffer's")
        .output("depths", PortKind::Texture,
                "The same as images: bits of the view depth, those of infinity where a slot is empty")
        .internal("counts", PortKind::Texture, "Fragments a texel so far, for the reservoir")
        .number("layers_per_texel", &StochasticDepthRaster::layers, 1, 16, "slots",
                "Depths that a texel keeps at most (K)")
        .choice("collection", &StochasticDepthRaster::collection, {"coverage_mask", "reservoir", "k_buffer"},
                "Which fragments stay: per slot the nearest of a random subset; a random sample; the nearest")
        .flag("interval", &StochasticDepthRaster::interval,
              "Keeps only what lies between the distances that the samples need")
        .number("divisor", &StochasticDepthRaster::divisor, 1, 16, "",
                "Of the frame's resolution per axis, where no mask gives the map's")
        .number("guard", &StochasticDepthRaster::guard, 0, 4096, "pixels",
                "Guard band, where no mask gives the map's; that of the depth at least");
}

Declaration StochasticDepthRaster::declare(const World& world, const Inputs& inputs,
                                           const Demand& demand) const {
    Declaration declaration;
    const MapShape map = mapShape(world, inputs, interval, divisor, guard, declaration.problems);
    Desc depths = Desc::array2D(Format::R32UI,
                                {map.extent.width, map.extent.height, static_cast<std::uint32_t>(layers)});
    depths.view = map.view;

    Output images{.port = "depths", .desc = depths};
    const glm::vec4 infinity(0x7f800000); // its bits
    const bool nothing = world.facts.triangles == 0 || map.empty;
    (nothing ? images.constant : images.clear) = infinity;
    declaration.outputs.push_back(std::move(images));
    if (demand.reads("layers")) {
        const DepthLayers told{
            .count = layers, .linear = true, .ordered = collection == Collection::KBuffer || layers == 1};
        declaration.outputs.push_back({.port = "layers", .desc = Desc::layersModule(told, map.view)});
        declaration.modules.push_back(depthMapModule(depths, layers, false));
    }
    if (nothing) {
        declaration.leftOut.push_back({"drawing", "no texel is asked for"});
        return declaration;
    }
    if (!world.facts.hasMasked)
        declaration.leftOut.push_back({"alpha test", "no material is masked or blended"});

    Step draw{.name = "draw",
              .shaders = {"stochastic_depth/scene.vert", "stochastic_depth/raster.frag"},
              .defines = materialDefines(world.facts),
              .uses = {{.port = "view_depth", .access = Access::Image},
                       {.port = "depths", .access = Access::Image, .write = true}},
              .group = "generation"};
    constexpr const char* names[] = {"COVERAGE_MASK", "RESERVOIR", "K_BUFFER"};
    draw.defines.emplace(names[static_cast<int>(collection)], "1");
    draw.defines.emplace("LAYERS", std::to_string(layers));
    draw.defines.emplace("MAP", "1");
    if (map.whole) {
        draw.defines.emplace("WHOLE_MAP", "1");
    } else if (interval) {
        draw.defines.emplace("INTERVAL", "1");
        draw.uses.push_back({.port = "ray_min", .access = Access::Image});
        draw.uses.push_back({.port = "ray_max", .access = Access::Image});
    } else {
        draw.uses.push_back({.port = "sd_mask", .access = Access::Image});
    }
    if (collection == Collection::Reservoir) {
        declaration.outputs.push_back({.port = "counts",
                                       .desc = Desc::texture2D(Format::R32UI, map.extent, map.view),
                                       .clear = glm::vec4(0)});
        draw.uses.push_back({.port = "counts", .access = Access::Image, .write = true});
    }
    declaration.steps.push_back(std::move(draw));
    declaration.depends = Causes::Camera | Causes::Cut | Causes::Geometry | Causes::Transforms |
                          Causes::Materials | Causes::Properties | Causes::Size;
    return declaration;
}

void StochasticDepthRaster::execute(const Step&, Commands& commands) {
    const Extent extent = commands.desc("depths").extent;
    DrawState state = DrawState::overwrite();
    state.viewport = glm::uvec2(extent.width, extent.height);
    commands.drawScene(state, {TriangleClass::Opaque, TriangleClass::OpaqueDoubleSided, TriangleClass::Masked,
                               TriangleClass::MaskedDoubleSided});
}

} // namespace kestrel
