#include "ambient_occlusion_refine.h"
#include "draw/material_defines.h"
#include "execute/commands.h"
#include "shared/work_list.h"
#include <cstddef>
#include <fmt/format.h>

namespace kestrel {

// Samples whose rays one step traces: the loop of a traversal counts in each.
static constexpr int raysPerStep = 8;

PassType AmbientOcclusionRefine::type() {
    return Describe<AmbientOcclusionRefine>("AmbientOcclusionRefine",
                                            "Refines ambient occlusion where the first surface hides what "
                                            "occludes: by depth layers, or by all hits along rays")
        .input("visibility", PortKind::Texture, "What AmbientOcclusionFirst makes: visibility")
        .carries({.channels = 1})
        .input("mean", PortKind::Texture, "Of the same: mean")
        .carries({.channels = 1})
        .sameExtentAs("visibility")
        .input("mask", PortKind::Texture, "Of the same: mask (AO-mask)")
        .carries({.channels = 1})
        .sameExtentAs("visibility")
        .input("pixels", PortKind::Buffer, "Of the same: pixels")
        .carries(content::elements("WorkListHeader"))
        .input("settings", PortKind::Buffer, "Of the same: settings")
        .carries(content::elements("OcclusionKernel"))
        .input("view_depth", PortKind::Texture, "The depth that the first pass read")
        .carries(content::viewDepth)
        .input("normal", PortKind::Texture, "The normals that the first pass read")
        .carries(content::normal)
        .sameExtentAs("view_depth")
        .optionalInput("second_depth", PortKind::Texture, "For `dual`: as the first pass has it")
        .carries(content::viewDepth)
        .sameExtentAs("view_depth")
        .optionalInput("layers", PortKind::Layers, "Depths behind the first surface, for `source` layers")
        .optionalInput("hits", PortKind::Hits, "Who enumerates what rays meet, for `source` hits")
        .output("result", PortKind::Texture, "Visibility, refined")
        .carries({.channels = 1})
        .range(0, 1)
        .internal("delta", PortKind::Texture, "Changes of the mean so far, where several steps share it")
        .choice("source", &AmbientOcclusionRefine::source, {"layers", "hits"},
                "Depth layers (SVAO by a stochastic depth map), or every hit (Ray-SVAO)")
        .flag("dual", &AmbientOcclusionRefine::dual, "The first pass is `dual`");
}

Declaration AmbientOcclusionRefine::declare(const World& world, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Desc& visibility = inputs["visibility"].desc;
    const char* const port = source == Source::Layers ? "layers" : "hits";
    if (!inputs.connected(port))
        declaration.problems.push_back({port, fmt::format("`source` {} needs it connected", port)});
    if (dual && !inputs.connected("second_depth"))
        declaration.problems.push_back({"second_depth", "`dual` needs it connected"});
    if (inputs["mask"].constant == glm::vec4(0)) {
        declaration.outputs.push_back({.port = "result", .desc = visibility, .same = "visibility"});
        declaration.leftOut.push_back({"refining", "nothing is marked"});
        return declaration;
    }
    declaration.outputs.push_back({.port = "result", .desc = visibility, .updates = "visibility"});

    const Format maskFormat = inputs["mask"].desc.format;
    const int bits = 8 * formatInfo(maskFormat).bytes;
    const int each = source == Source::Hits ? raysPerStep : bits, steps = (bits + each - 1) / each;
    if (steps > 1) {
        Desc delta = visibility;
        delta.format = Format::R32F;
        declaration.outputs.push_back({.port = "delta", .desc = delta});
    }
    for (int i = 0; i < steps; ++i) {
        Step step{.name = fmt::format("refine{}", i),
                  .shaders = {"ambient_occlusion/refine.comp"},
                  .uses = {{.port = "view_depth", .access = Access::Image},
                           {.port = "normal", .access = Access::Image},
                           {.port = "mean", .access = Access::Image},
                           {.port = "mask", .access = Access::Image},
                           {.port = "settings", .access = Access::Uniform},
                           {.port = "pixels", .access = Access::Storage},
                           {.port = "pixels", .access = Access::Indirect}},
                  .group = source == Source::Hits ? "tracing" : ""};
        if (source == Source::Hits) step.defines = materialDefines(world.facts);
        const std::uint64_t mask = ((std::uint64_t{1} << each) - 1) << (i * each);
        step.defines.emplace("SAMPLE_BITS", fmt::format("{}u", mask));
        step.defines.emplace("MASK_FORMAT", std::string(formatInfo(maskFormat).name));
        if (i > 0) step.defines.emplace("CONTINUES", "1");
        if (i + 1 == steps) {
            step.defines.emplace("ENDS", "1");
            step.uses.push_back({.port = "result", .access = Access::Image, .write = true});
        }
        if (steps > 1) step.uses.push_back({.port = "delta", .access = Access::Image, .write = true});
        if (dual) {
            step.defines.emplace("DUAL", "1");
            step.uses.push_back({.port = "second_depth", .access = Access::Image});
        }
        if (source == Source::Hits) {
            step.defines.emplace("BY_HITS", "1");
            step.modules.push_back({"hits", requests::AllHits});
        } else {
            if (inputs.connected("layers") && inputs["layers"].desc.depthLayers.ordered)
                step.defines.emplace("IN_ORDER", "1");
            step.modules.push_back({"layers", 0});
        }
        declaration.steps.push_back(std::move(step));
    }
    declaration.depends = Causes::Properties;
    return declaration;
}

void AmbientOcclusionRefine::execute(const Step&, Commands& commands) {
    commands.dispatchIndirect("pixels", offsetof(shared::WorkListHeader, groups));
}

} // namespace kestrel
