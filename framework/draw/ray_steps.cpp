#include "draw/ray_steps.h"
#include "draw/material_defines.h"
#include <algorithm>

namespace kestrel {

int raysPerStep(const Desc& tracer) { return tracer.lists == FragmentLists{} ? maxRaysPerStep : 4; }

std::vector<Step> raySteps(Step step, int rays, const Desc& tracer, const SceneFacts& facts) {
    const int atOnce = raysPerStep(tracer);
    step.group = "tracing";
    step.defines.merge(materialDefines(facts));
    step.defines.insert_or_assign("TOTAL_RAYS", std::to_string(rays));
    std::vector<Step> steps;
    for (int first = 0; first < rays; first += atOnce) {
        Step one = step;
        one.name = "trace" + std::to_string(steps.size());
        one.defines.insert_or_assign("RAYS", std::to_string(std::min(atOnce, rays - first)));
        one.defines.insert_or_assign("FIRST_RAY", std::to_string(first));
        if (first > 0) one.defines.emplace("CONTINUES", "1");
        if (first + atOnce >= rays) one.defines.emplace("ENDS", "1");
        steps.push_back(std::move(one));
    }
    return steps;
}

} // namespace kestrel
