#include "depth_peeling.h"
#include "blended_layers.h"
#include "execute/commands.h"
#include <fmt/format.h>

namespace kestrel {

PassType DepthPeeling::type() {
    return Describe<DepthPeeling>("DepthPeeling",
                                  "The nearest blended surfaces at each pixel, each by drawing "
                                  "once more")
        .input("depth", PortKind::Texture, "Reversed depth of what is opaque")
        .carries(content::depth)
        .output("layers", PortKind::Layers, "The surfaces before it, nearest first, with their triangles")
        .internal("peeled", PortKind::Texture, "Reversed depth of each layer; 0 where there is none")
        .internal("triangles", PortKind::Texture, "Their triangles")
        .internal("nearest", PortKind::Texture, "Depth attachment of each layer")
        .number("layers_per_pixel", &DepthPeeling::layers, 1, 64, "layers",
                "Surfaces that are found at each pixel");
}

Declaration DepthPeeling::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const Desc& depth = inputs["depth"].desc;
    const Extent extent{depth.extent.width, depth.extent.height, static_cast<std::uint32_t>(layers)};
    const bool nothing = !world.facts.hasBlend;
    for (const auto& [port, format] :
         {std::pair{"peeled", Format::R32F}, {"triangles", Format::R32UI}, {"nearest", Format::D32F}}) {
        Output output{.port = port, .desc = Desc::array2D(format, extent)};
        output.desc.view = depth.view;
        (nothing ? output.constant : output.clear) = glm::vec4(0);
        declaration.outputs.push_back(std::move(output));
    }
    declareBlendedLayers(depth, layers, "peeled", demand, declaration);
    if (nothing) {
        declaration.leftOut.push_back({"peeling", "no material is blended"});
        return declaration;
    }
    for (int i = 0; i < layers; ++i) {
        Step step = blendedStep(world, fmt::format("peel{}", i), "transparency/peel.frag");
        for (const char* port : {"peeled", "triangles", "nearest"})
            step.uses.push_back({.port = port, .access = Access::Attachment, .write = true, .layer = i});
        if (i > 0) {
            step.uses.push_back({.port = "peeled", .access = Access::Image, .layer = i - 1});
            step.defines.emplace("BEHIND", "1");
        }
        step.run = [](Commands& commands) { commands.drawScene({}, blendedClasses()); };
        declaration.steps.push_back(std::move(step));
    }
    declaration.depends = blendedCauses;
    return declaration;
}

} // namespace kestrel
