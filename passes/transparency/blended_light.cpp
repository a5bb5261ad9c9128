#include "blended_light.h"
#include "draw/material_defines.h"

namespace kestrel {

bool leavesOutBlended(const World& world, Declaration& declaration) {
    if (world.facts.hasBlend) return false;
    declaration.outputs.front().same = "picture";
    declaration.leftOut.push_back({"compositing", "no material is blended: the picture stays as it is"});
    return true;
}

void checkBlendedView(const Desc& depth, Declaration& declaration) {
    View view = depth.view;
    view.jitter = false;
    if (view != View{})
        declaration.problems.push_back(
            {"depth", "is not what the frame's camera sees, pixel by pixel and without guard band"});
}

void lightBlended(const World& world, const Inputs& inputs, const glm::vec3& ambient, Step& step) {
    step.defines.merge(materialDefines(world.facts, Blended::Alone));
    if (ambient != glm::vec3(0)) step.defines.emplace("AMBIENT", "1");
    if (!inputs.connected("radiance")) return;
    step.defines.emplace("RADIANCE", "1");
    step.modules.push_back({"radiance", 0});
}

} // namespace kestrel
