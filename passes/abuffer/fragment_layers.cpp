#include "fragment_layers.h"
#include "views.h"

namespace kestrel {

void declareFragmentLayers(const World& world, const Inputs& inputs, const Demand& demand,
                           Declaration& declaration) {
    if (!demand.reads("layers")) return;
    const FragmentLists& lists = inputs["nodes"].desc.lists;
    if (!lists.mainView)
        declaration.leftOut.push_back({"layers", "the frame's view is not among those of the A-buffer"});
    declaration.outputs.push_back(
        {.port = "layers",
         .desc = Desc::layersModule({.count = fragmentLayers, .ordered = true, .blended = lists.blended}, {},
                                    provides::Surface)});
    Module layers{
        .port = "layers", .shader = "abuffer/layers.glsl", .defines = abufferDefines(lists, world.size)};
    layers.defines.emplace("LAYERS", std::to_string(fragmentLayers));
    if (inputs["nodes"].constant || !lists.mainView) {
        layers.defines.emplace("EMPTY", "1");
    } else {
        layers.uses = {{.port = "pixels", .access = Access::Image},
                       {.port = "nodes", .access = Access::Image}};
        if (lists.decoupled && (demand.requests("layers") & requests::Surface) != 0)
            layers.uses.push_back({.port = "data", .access = Access::Image});
    }
    declaration.modules.push_back(std::move(layers));
}

} // namespace kestrel
