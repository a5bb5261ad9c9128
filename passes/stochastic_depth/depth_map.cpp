#include "depth_map.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel {

Desc depthMapDesc(int layers, const Extent& extent, const View& view) {
    const Format format = layers == 1 ? Format::R32F : layers == 2 ? Format::RG32F : Format::RGBA32F;
    Desc desc =
        Desc::array2D(format, {extent.width, extent.height, static_cast<std::uint32_t>((layers + 3) / 4)});
    desc.view = view;
    return desc;
}

Module depthMapModule(const Desc& depths, int layers, bool jitter) {
    Module module{.port = "layers",
                  .shader = "stochastic_depth/layers.glsl",
                  .defines = {{"LAYERS", std::to_string(layers)}, {"JITTER", jitter ? "true" : "false"}},
                  .uses = {{.port = "depths", .access = Access::Image}}};
    const FormatInfo& format = formatInfo(depths.format);
    if (format.integer)
        module.defines.emplace("DEPTH_BITS", "1");
    else
        module.defines.emplace("DEPTHS_FORMAT", std::string(format.name));
    return module;
}

MapShape mapShape(const World& world, const Inputs& inputs, bool interval, int divisor, int guard,
                  std::vector<DeclarationProblem>& problems) {
    MapShape map;
    map.mask = interval ? "ray_max" : "sd_mask";
    map.whole = !inputs.connected("sd_mask") && !inputs.connected("ray_min") && !inputs.connected("ray_max");
    if (map.whole) {
        const Inputs::Input& depth = inputs["view_depth"];
        const int band = std::max(guard, depth.desc.view.guard);
        map.view = {.source = depth.desc.view.source,
                    .divisor = divisor,
                    .guard = (band + divisor - 1) / divisor * divisor};
        map.extent = world.extentOf(map.view);
        map.empty = depth.constant == glm::vec4(0);
    } else if (!inputs.connected(map.mask) || (interval && !inputs.connected("ray_min"))) {
        const char* const missing = inputs.connected(map.mask) ? "ray_min" : map.mask;
        problems.push_back({missing, fmt::format("`interval` {} needs it connected", interval)});
        return map;
    } else {
        map.extent = inputs[map.mask].desc.extent;
        map.view = inputs[map.mask].desc.view;
        map.empty = inputs[map.mask].constant == glm::vec4(0);
    }
    if (!std::holds_alternative<FrameView>(map.view.source))
        problems.push_back({map.whole ? "view_depth" : map.mask, "is not seen by the frame's camera"});
    return map;
}

} // namespace kestrel
