#include "ambient_occlusion_first.h"
#include "execute/commands.h"
#include "shared/ambient_occlusion.h"
#include "shared/work_list.h"
#include <algorithm>
#include <cstddef>
#include <fmt/format.h>

namespace kestrel {

static_assert(sizeof(shared::OcclusionKernel) == 32 + 16 * shared::maxDiscSamples);
static_assert(offsetof(shared::WorkListHeader, groups) == 16);

PassType AmbientOcclusionFirst::type() {
    return Describe<AmbientOcclusionFirst>(
               "AmbientOcclusionFirst",
               "Volumetric or horizon-based ambient occlusion from the depth buffer, with masks of what a "
               "second pass can refine")
        .input("view_depth", PortKind::Texture, "Distance along the view axis; 0 where nothing is")
        .carries(content::viewDepth)
        .input("normal", PortKind::Texture, "Normals of the surfaces, unit, render space")
        .carries(content::normal)
        .sameExtentAs("view_depth")
        .optionalInput("second_depth", PortKind::Texture,
                       "View depth of the second layer, for `dual`; 0 where nothing is")
        .carries(content::viewDepth)
        .sameExtentAs("view_depth")
        .output("visibility", PortKind::Texture, "Visibility by what the depth shows; 1 where nothing is")
        .carries({.channels = 1})
        .range(0, 1)
        .output("mean", PortKind::Texture, "The same before it is clamped and raised to the exponent")
        .carries({.channels = 1})
        .output("mask", PortKind::Texture,
                "A bit a sample: the first surface may hide what occludes it (AO-mask)")
        .carries({.channels = 1})
        .output("pixels", PortKind::Buffer, "The pixels with a mask, as a list (shared/work_list.h)")
        .carries(content::elements("WorkListHeader"))
        .output("settings", PortKind::Buffer, "Samples and parameters (shared/ambient_occlusion.h)")
        .carries(content::elements("OcclusionKernel"))
        .output("sd_mask", PortKind::Texture,
                "Of the stochastic depth map's size: 1 where a sample needs the texel (SD-mask)")
        .carries({.channels = 1})
        .output("sd_cells", PortKind::Texture,
                "Of that size: the cells, a quarter of a texel per axis, that samples fall into, a bit each")
        .carries({.channels = 1})
        .output("ray_min", PortKind::Texture,
                "Of that size: where the texel's ray interval begins, as float bits; infinity without a mask")
        .carries({.channels = 1})
        .output("ray_max", PortKind::Texture, "And where it ends; 0 without a mask")
        .carries({.channels = 1})
        .choice("kernel", &AmbientOcclusionFirst::kernel, {"vao", "hbao"},
                "Volumetric, or horizon-based (with 1.5 times the radius it looks alike)")
        .choice("samples", &AmbientOcclusionFirst::samples, {"8", "16", "32"}, "Samples a pixel")
        .number("radius", &AmbientOcclusionFirst::radius, 1e-9, 1e9, "scene units",
                "Of the sphere in which occluders count")
        .number("exponent", &AmbientOcclusionFirst::exponent, 0.1, 16, "", "Power of the result")
        .number("thickness", &AmbientOcclusionFirst::thickness, 0, 1, "radii",
                "How far before the sphere occluders still count whole")
        .number("cutoff", &AmbientOcclusionFirst::cutoff, 0, 1000, "pixels",
                "Samples nearer than that on screen are not refined")
        .number("maximum_radius", &AmbientOcclusionFirst::maximumRadius, 1, 4096, "pixels",
                "The radius is made smaller where it would look larger")
        .flag("dual", &AmbientOcclusionFirst::dual, "Uses the second depth where the first may hide")
        .number("divisor", &AmbientOcclusionFirst::divisor, 1, 16, "",
                "The stochastic depth map has the frame's resolution per axis divided by this")
        .number("guard", &AmbientOcclusionFirst::guard, 0, 4096, "pixels",
                "Guard band of the stochastic depth map; samples that leave the image for it are refined");
}

// The map covers the depth, guard band included.
View AmbientOcclusionFirst::mapView(const View& depth) const {
    return {.source = depth.source,
            .divisor = divisor,
            .guard = (std::max(guard, depth.guard) + divisor - 1) / divisor * divisor};
}

Declaration AmbientOcclusionFirst::declare(const World& world, const Inputs& inputs,
                                           const Demand& demand) const {
    Declaration declaration;
    const Desc& depth = inputs["view_depth"].desc;
    const bool second = dual && inputs.connected("second_depth");
    if (dual && !second) declaration.problems.push_back({"second_depth", "`dual` needs it connected"});

    View inner = depth.view;
    inner.guard = 0;
    const Extent extent = world.extentOf(inner), map = world.extentOf(mapView(depth.view));
    const int count = sampleCount();
    const Format maskFormat = count == 8 ? Format::R8UI : count == 16 ? Format::R16UI : Format::R32UI;
    const std::uint64_t listBytes =
        sizeof(shared::WorkListHeader) + std::uint64_t{4} * extent.width * extent.height;
    if (static_cast<std::int64_t>(listBytes) > world.capabilities.maxStorageBlockBytes)
        declaration.problems.push_back({"pixels", "the frame has more pixels than a buffer can list", true});

    const bool empty = inputs["view_depth"].constant == glm::vec4(0);
    const auto output = [&](const char* port, const Desc& desc, std::optional<glm::vec4> background,
                            std::optional<glm::vec4> clear = {}) {
        Output made{.port = port, .desc = desc};
        if (empty && background)
            made.constant = background;
        else
            made.clear = clear;
        declaration.outputs.push_back(std::move(made));
    };
    const auto mapOutput = [&](const char* port, Format format, float clear) {
        output(port, Desc::texture2D(format, map, mapView(depth.view)), glm::vec4(clear), glm::vec4(clear));
    };
    const bool marks = demand.reads("sd_mask") || demand.reads("sd_cells") || demand.reads("ray_min") ||
                       demand.reads("ray_max");
    const bool lists = demand.reads("pixels") || marks;
    const bool masks = demand.reads("mask") || lists;
    output("visibility", Desc::texture2D(Format::R16F, extent, inner), glm::vec4(1));
    output("settings", Desc::buffer(sizeof(shared::OcclusionKernel)), {});
    if (demand.reads("mean")) output("mean", Desc::texture2D(Format::R16F, extent, inner), glm::vec4(1));
    if (masks) output("mask", Desc::texture2D(maskFormat, extent, inner), glm::vec4(0));
    if (lists) output("pixels", Desc::buffer(listBytes, Format::R32UI), glm::vec4(0));
    if (demand.reads("sd_mask")) mapOutput("sd_mask", Format::R8UI, 0);
    if (demand.reads("sd_cells")) mapOutput("sd_cells", Format::R32UI, 0);
    const bool interval = demand.reads("ray_min") || demand.reads("ray_max");
    if (interval) {
        mapOutput("ray_min", Format::R32UI, 0x7f800000); // the bits of infinity
        mapOutput("ray_max", Format::R32UI, 0);
    }

    Step prepare{.name = "prepare",
                 .run = &AmbientOcclusionFirst::prepare,
                 .uses = {{.port = "settings", .access = Access::Copy, .write = true}}};
    if (lists && !empty) prepare.uses.push_back({.port = "pixels", .access = Access::Copy, .write = true});
    declaration.steps.push_back(std::move(prepare));
    declaration.depends = Causes::Properties;
    if (empty) {
        declaration.leftOut.push_back({"occlusion", "the depth is empty everywhere"});
        return declaration;
    }

    const auto imageOf = [](const char* port, bool write) {
        return Use{.port = port, .access = Access::Image, .write = write};
    };
    const Defines defines = {{"SAMPLES", std::to_string(count)},
                             {kernel == OcclusionKernelType::Vao ? "KERNEL_VAO" : "KERNEL_HBAO", "1"},
                             {"MASK_FORMAT", std::string(formatInfo(maskFormat).name)}};
    Step first{.name = "first",
               .run = &AmbientOcclusionFirst::occlude,
               .shaders = {"ambient_occlusion/first.comp"},
               .defines = defines,
               .uses = {imageOf("view_depth", false),
                        imageOf("normal", false),
                        imageOf("visibility", true),
                        {.port = "settings", .access = Access::Uniform}}};
    if (second) {
        first.defines.emplace("DUAL", "1");
        first.uses.push_back(imageOf("second_depth", false));
    }
    if (demand.reads("mean")) {
        first.defines.emplace("MEAN", "1");
        first.uses.push_back(imageOf("mean", true));
    }
    if (masks) {
        first.defines.emplace("MASK", "1");
        first.uses.push_back(imageOf("mask", true));
    } else {
        declaration.leftOut.push_back({"masks", "nobody refines what they mark"});
    }
    declaration.steps.push_back(std::move(first));
    // A step of its own: atomics are paid for by all lanes, wanted or not, and so one serves several pixels.
    if (lists)
        declaration.steps.push_back(
            {.name = "list",
             .run = &AmbientOcclusionFirst::list,
             .shaders = {"stochastic_depth/list.comp"},
             .defines = {{"WANTED", "mask"},
                         {"WANTED_FORMAT", std::string(formatInfo(maskFormat).name)},
                         {"LIST", "Pixels"}},
             .uses = {imageOf("mask", false), {.port = "pixels", .access = Access::Storage, .write = true}}});
    if (!marks) return declaration;

    Step mark{.name = interval ? "interval" : "sd_mask",
              .run = &AmbientOcclusionFirst::mark,
              .shaders = {"ambient_occlusion/interval.comp"},
              .defines = defines,
              .uses = {imageOf("view_depth", false),
                       imageOf("normal", false),
                       imageOf("mask", false),
                       {.port = "settings", .access = Access::Uniform},
                       {.port = "pixels", .access = Access::Storage},
                       {.port = "pixels", .access = Access::Indirect}}};
    mark.defines.emplace("MAP_VIEW", interval                  ? "RayMinView"
                                     : demand.reads("sd_mask") ? "SdMaskView"
                                                               : "SdCellsView");
    if (demand.reads("sd_mask")) {
        mark.defines.emplace("SD_MASK", "1");
        mark.uses.push_back(imageOf("sd_mask", true));
    }
    if (demand.reads("sd_cells")) {
        mark.defines.emplace("SD_CELLS", "1");
        mark.uses.push_back(imageOf("sd_cells", true));
    }
    if (interval) {
        mark.defines.emplace("INTERVAL", "1");
        if (second) {
            mark.defines.emplace("DUAL", "1");
            mark.uses.push_back(imageOf("second_depth", false));
        }
        mark.uses.push_back(imageOf("ray_min", true));
        mark.uses.push_back(imageOf("ray_max", true));
    }
    declaration.steps.push_back(std::move(mark));
    return declaration;
}

void AmbientOcclusionFirst::prepare(Commands& commands) const {
    shared::OcclusionKernel data{radius, exponent, thickness, cutoff, maximumRadius, 0, 0, 0, {}};
    data.kernel = kernel == OcclusionKernelType::Vao ? shared::kernelVao : shared::kernelHbao;
    data.samples = static_cast<std::uint32_t>(sampleCount());
    const std::vector<glm::vec4> disc = discSamples(kernel, sampleCount());
    std::copy(disc.begin(), disc.end(), data.disc);
    commands.uploadValue("settings", data);
    if (commands.uses("pixels"))
        commands.uploadValue("pixels", shared::WorkListHeader{0, 0, 0, 0, {0, 1, 1, 0}});
}

void AmbientOcclusionFirst::occlude(Commands& commands) const {
    const Desc& depth = commands.desc("view_depth");
    if (commands.uses("mask")) {
        const int more = std::max(guard - depth.view.guard, 0);
        commands.set("reach", static_cast<float>(more) / static_cast<float>(depth.view.divisor));
    }
    commands.dispatchOver(commands.desc("visibility").extent);
}

void AmbientOcclusionFirst::list(Commands& commands) const {
    const Extent extent = commands.desc("mask").extent;
    commands.dispatchOver((extent.width + 7) / 8, extent.height);
}

void AmbientOcclusionFirst::mark(Commands& commands) const {
    commands.dispatchIndirect("pixels", offsetof(shared::WorkListHeader, groups));
}

} // namespace kestrel
