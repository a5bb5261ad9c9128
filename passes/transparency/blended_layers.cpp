#include "blended_layers.h"
#include "blended_light.h"
#include "draw/material_defines.h"
#include <string_view>

namespace kestrel {

Step blendedStep(const World& world, std::string name, const char* fragmentShader) {
    return {.name = std::move(name),
            .shaders = {"transparency/scene.vert", fragmentShader},
            .defines = materialDefines(world.facts, Blended::Alone),
            .uses = {{.port = "depth", .access = Access::Fetch}},
            .group = "generation"};
}

std::vector<TriangleClass> blendedClasses() {
    return {TriangleClass::Masked, TriangleClass::MaskedDoubleSided};
}

void declareBlendedLayers(const Desc& depth, int count, const char* depths, const Demand& demand,
                          Declaration& declaration) {
    checkBlendedView(depth, declaration);
    declaration.outputs.push_back(
        {.port = "layers",
         .desc = Desc::layersModule({.count = count, .ordered = true, .blended = Blended::Alone}, depth.view,
                                    provides::Surface)});
    Module module{.port = "layers",
                  .shader = "transparency/layers.glsl",
                  .defines = {{"LAYERS", std::to_string(count)}},
                  .uses = {{.port = depths, .access = Access::Image}}};
    if ((demand.requests("layers") & requests::Surface) != 0)
        module.uses.push_back({.port = "triangles", .access = Access::Image});
    if (depths != std::string_view("peeled")) module.defines.emplace("DEPTH_BITS", "1");
    declaration.modules.push_back(std::move(module));
}

} // namespace kestrel
