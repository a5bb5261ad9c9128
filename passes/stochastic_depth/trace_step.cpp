#include "trace_step.h"
#include "draw/material_defines.h"
#include "shared/work_list.h"

namespace kestrel {

Step traceStep(const World& world, const TexelTracing& tracing, const Desc& depths, StepRun run) {
    Step trace{.name = "trace",
               .run = std::move(run),
               .shaders = {"stochastic_depth/trace.comp"},
               .defines = materialDefines(world.facts),
               .uses = {{.port = "view_depth", .access = Access::Image},
                        {.port = "depths", .access = Access::Image, .write = true}},
               .modules = {{"hits", requests::AllHits}},
               .group = "tracing"};
    constexpr const char* names[] = {"RESERVOIR", "COVERAGE_MASK", "K_BUFFER"};
    trace.defines.emplace(names[static_cast<int>(tracing.collection)], "1");
    trace.defines.emplace("LAYERS", std::to_string(tracing.layers));
    trace.defines.emplace("MAX_COUNT", std::to_string(tracing.maxCount));
    trace.defines.emplace("Z_CULL", tracing.zCull ? "true" : "false");
    trace.defines.emplace("JITTER", tracing.jitter ? "true" : "false");
    trace.defines.emplace("DEPTHS_FORMAT", std::string(formatInfo(depths.format).name));
    if (tracing.wholeMap) {
        trace.defines.emplace("WHOLE_MAP", "1");
    } else {
        trace.uses.push_back({.port = "texels", .access = Access::Storage});
        trace.uses.push_back({.port = "texels", .access = Access::Indirect});
    }
    if (tracing.intervalTexels > 0) {
        trace.defines.emplace("INTERVAL", std::to_string(tracing.intervalTexels));
        trace.uses.push_back({.port = "ray_min", .access = Access::Image});
        trace.uses.push_back({.port = "ray_max", .access = Access::Image});
    }
    return trace;
}

Desc texelListDesc(std::uint64_t texels) { return Desc::buffer(sizeof(shared::WorkListHeader) + 4 * texels); }

} // namespace kestrel
