#include "depth_map.h"

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

} // namespace kestrel
