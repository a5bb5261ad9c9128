#include "debug_view.h"
#include "execute/commands.h"
#include "image/colormap.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel {
namespace {

const char* samplerOf(const Desc& desc) {
    switch (desc.kind) {
    case ResourceKind::Texture2DArray:
        return "sampler2DArray";
    case ResourceKind::TextureCube:
        return "samplerCube";
    case ResourceKind::Texture3D:
        return "sampler3D";
    default:
        return "sampler2D";
    }
}

// The colour map as a texture buffer's content would be a resource for 768 numbers; a constant array is in
// the program.
std::string colourTable() {
    std::string table = "vec3[17](";
    for (int i = 0; i <= 16; ++i) {
        const auto c = colorOf(ColorMap::Magma, static_cast<float>(i) / 16.0f);
        table += fmt::format("{}vec3({:.6f}, {:.6f}, {:.6f})", i == 0 ? "" : ", ", c[0], c[1], c[2]);
    }
    return table + ")";
}

} // namespace

PassType DebugView::type() {
    return Describe<DebugView>("DebugView", "Makes any texture visible, or a slice of an occupancy map")
        .optionalInput("source", PortKind::Texture, "What is looked at")
        .optionalInput("occupancy", PortKind::Buffer, "Or an occupancy map, with its grid")
        .carries(content::elements("OccupancyWord"))
        .optionalInput("grid", PortKind::Buffer, "Where the cells of the occupancy map lie")
        .carries(content::elements("OccupancyGrid"))
        .displayOutput("image", "What is seen, as display values")
        .choice("show", &DebugView::show, {"colour", "red", "green", "blue", "alpha", "normal", "heat_map"},
                "Which channels, and how; normal maps -1..1 to 0..1")
        .vector("range", &DebugView::range, -1e9, 1e9, "", "The values that are shown as black and white")
        .number("layer", &DebugView::layer, 0, 2047, "", "Of an array texture")
        .number("mip", &DebugView::mip, 0, 15, "", "Mip level")
        .number("slice", &DebugView::slice, 0, 1, "",
                "Height along z of a 3D texture or of an occupancy map");
}

Declaration DebugView::declare(const World&, const Inputs& inputs, const Demand&) const {
    if (inputs.connected("source")) return declareTexture(inputs["source"].desc);
    if (inputs.connected("occupancy") && inputs.connected("grid")) return declareOccupancy();
    Declaration declaration;
    declaration.outputs.push_back({.port = "image", .desc = Desc::texture2D(Format::RGBA8, {1, 1, 1})});
    declaration.outputs.back().constant = glm::vec4(0);
    declaration.problems.push_back({"", "needs 'source', or 'occupancy' and 'grid'"});
    return declaration;
}

Declaration DebugView::declareTexture(const Desc& desc) const {
    Declaration declaration;
    if (layer >= static_cast<int>(desc.extent.depth) && desc.kind == ResourceKind::Texture2DArray)
        declaration.problems.push_back(
            {"layer", fmt::format("is {}, but source has {} layers", layer, desc.extent.depth)});
    if (mip >= desc.mips)
        declaration.problems.push_back(
            {"mip", fmt::format("is {}, but source has {} mip levels", mip, desc.mips)});
    const Extent extent{std::max(1u, desc.extent.width >> mip), std::max(1u, desc.extent.height >> mip), 1};
    declaration.outputs.push_back(
        {.port = "image", .desc = Desc::texture2D(Format::RGBA8, extent, desc.view)});
    const FormatInfo& format = formatInfo(desc.format);
    Step step{.name = "show",
              .run = {&DebugView::showTexture, desc.kind},
              .shaders = {"display/debug_view.comp"},
              .defines = {{"SAMPLER", std::string(format.integer ? (format.isSigned ? "i" : "u") : "") +
                                          samplerOf(desc)},
                          {"SHOW", std::to_string(static_cast<int>(show))},
                          {"CHANNELS", std::to_string(format.channels)}},
              .uses = {{.port = "source", .access = Access::Fetch},
                       {.port = "image", .access = Access::Image, .write = true}},
              .group = "display"};
    if (desc.kind == ResourceKind::Texture2DArray) step.defines.emplace("LAYERED", "1");
    if (desc.kind == ResourceKind::Texture3D) step.defines.emplace("SOLID", "1");
    if (desc.kind == ResourceKind::TextureCube)
        declaration.problems.push_back({"source", "is a cube map, which cannot be shown"});
    if (show == Show::HeatMap) step.defines["COLOUR_TABLE"] = colourTable();
    declaration.steps.push_back(std::move(step));
    declaration.depends = Causes::Properties;
    return declaration;
}

Declaration DebugView::declareOccupancy() const {
    Declaration declaration;
    // Cells are shown on a fixed canvas: the map's resolution is in its grid, which only the shader knows.
    declaration.outputs.push_back({.port = "image", .desc = Desc::texture2D(Format::RGBA8, {512, 512, 1})});
    declaration.steps.push_back({.name = "slice",
                                 .run = &DebugView::showOccupancy,
                                 .shaders = {"display/occupancy_slice.comp"},
                                 .uses = {{.port = "occupancy", .access = Access::Image},
                                          {.port = "grid", .access = Access::Uniform},
                                          {.port = "image", .access = Access::Image, .write = true}},
                                 .group = "display"});
    declaration.depends = Causes::Properties;
    return declaration;
}

void DebugView::showTexture(Commands& commands, ResourceKind kind) const {
    commands.set("range", range);
    commands.set("mip", mip);
    if (kind == ResourceKind::Texture2DArray) commands.set("layer", layer);
    if (kind == ResourceKind::Texture3D) commands.set("slice", slice);
    commands.dispatchOver(commands.desc("image").extent);
}

void DebugView::showOccupancy(Commands& commands) const {
    commands.set("slice", slice);
    commands.dispatchOver(commands.desc("image").extent);
}

} // namespace kestrel
