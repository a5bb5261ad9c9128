#include "k_buffer.h"
#include "blended_layers.h"
#include "execute/commands.h"

namespace kestrel {

PassType KBuffer::type() {
    return Describe<KBuffer>("KBuffer", "The nearest blended surfaces at each pixel, by drawing twice")
        .input("depth", PortKind::Texture, "Reversed depth of what is opaque")
        .carries(content::depth)
        .output("layers", PortKind::Layers, "The surfaces before it, nearest first, with their triangles")
        .internal("depths", PortKind::Texture,
                  "Bits of their depths along the view's axis; those of infinity: none")
        .internal("triangles", PortKind::Texture, "Their triangles")
        .number("slots", &KBuffer::slots, 1, 64, "surfaces", "That are kept at each pixel (k)");
}

Declaration KBuffer::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const Desc& depth = inputs["depth"].desc;
    const Extent extent{depth.extent.width, depth.extent.height, static_cast<std::uint32_t>(slots)};
    const bool nothing = !world.facts.hasBlend;
    for (const char* port : {"depths", "triangles"}) {
        Output output{.port = port, .desc = Desc::array2D(Format::R32UI, extent)};
        output.desc.view = depth.view;
        (nothing ? output.constant : output.clear) = glm::vec4(0x7f800000);
        declaration.outputs.push_back(std::move(output));
    }
    declareBlendedLayers(depth, slots, "depths", demand, declaration);
    if (nothing) {
        declaration.leftOut.push_back({"drawing", "no material is blended"});
        return declaration;
    }
    for (const bool triangles : {false, true}) {
        Step step = blendedStep(world, triangles ? "triangles" : "depths", "transparency/k_buffer.frag");
        step.defines.emplace("LAYERS", std::to_string(slots));
        step.uses.push_back({.port = "depths", .access = Access::Image, .write = !triangles});
        if (triangles) {
            step.defines.emplace("TRIANGLES", "1");
            step.uses.push_back({.port = "triangles", .access = Access::Image, .write = true});
        }
        step.run = [extent](Commands& commands) {
            DrawState state = DrawState::overwrite();
            state.cull = Cull::Back;
            state.viewport = glm::uvec2(extent.width, extent.height);
            commands.drawScene(state, blendedClasses());
        };
        declaration.steps.push_back(std::move(step));
    }
    declaration.depends = blendedCauses;
    return declaration;
}

} // namespace kestrel
