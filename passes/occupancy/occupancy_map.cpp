#include "occupancy_map.h"
#include "exact_marking.h"
#include "execute/commands.h"
#include "grid.h"
#include "shared/random.h"
#include <algorithm>
#include <fmt/format.h>
#include <iterator>

namespace kestrel {
namespace {

constexpr const char* axisPorts[3] = {"columns_x", "columns_y", "columns_z"};
constexpr const char* highAxisPorts[3] = {"columns_x_high", "columns_y_high", "columns_z_high"};

bool makesColumns(OccupancyMethod method) {
    return method == OccupancyMethod::LogicOp || method == OccupancyMethod::Interlock ||
           method == OccupancyMethod::FramebufferFetch;
}

// The extension that a method cannot do without; nullptr: none.
const char* neededExtension(OccupancyMethod method) {
    if (method == OccupancyMethod::Interlock) return "GL_ARB_fragment_shader_interlock";
    if (method == OccupancyMethod::FramebufferFetch) return "GL_EXT_shader_framebuffer_fetch";
    return nullptr;
}

const std::vector<TriangleClass> oneSidedClasses = {TriangleClass::Opaque, TriangleClass::Masked};
const std::vector<TriangleClass> doubleSidedClasses = {TriangleClass::OpaqueDoubleSided,
                                                       TriangleClass::MaskedDoubleSided};

} // namespace

PassType OccupancyMap::type() {
    Describe<OccupancyMap> table("OccupancyMap",
                                 "One bit a cell of a cube around the scene: is there a surface?");
    table.output("occupancy", PortKind::Buffer, "The bits, 32 cells along z a word")
        .carries(content::elements("OccupancyWord"))
        .output("grid", PortKind::Buffer, "Where the cells lie")
        .carries(content::elements("OccupancyGrid"));
    for (int axis = 0; axis < 3; ++axis)
        table
            .internal(axisPorts[axis], PortKind::Texture,
                      fmt::format("Columns of cells along {}: 128 bits a texel", "xyz"[axis]))
            .internal(highAxisPorts[axis], PortKind::Texture,
                      fmt::format("Cells 128 to 255 of the columns along {}", "xyz"[axis]));
    table.internal("large", PortKind::Buffer, "Triangles over many cells, and the work groups that mark them")
        .number("resolution", &OccupancyMap::resolution, 32, 256, "cells",
                "Cells along an edge: 32, 64, 128 or 256")
        .choice(
            "method", &OccupancyMap::method,
            {"three_axis", "logic_op", "interlock", "framebuffer_fetch", "dominant_axis", "exact",
             "separating"},
            "How cells are marked: rasterized along three axes (four ways that give the same bits) or each "
            "triangle along one; exact: all that a triangle meets; separating: those that it passes in the "
            "columns along its steepest axis whose middles it meets, closed but for creases")
        .flag("jitter", &OccupancyMap::jitter,
              "Shifts the cells by up to half of one, differently every frame")
        .number("inset", &OccupancyMap::inset, 0, 0.5, "cells",
                "How far behind one-sided surfaces their cells are marked, by all methods but exact: cells "
                "make everything thicker");
    return table;
}

Declaration OccupancyMap::declare(const World& world, const Inputs&, const Demand& demand) const {
    Declaration declaration;
    if (!isOccupancyResolution(resolution)) {
        declaration.problems.push_back(
            {"resolution", fmt::format("must be 32, 64, 128 or 256, not {}", resolution)});
        return declaration;
    }
    const char* extension = neededExtension(method);
    if (extension && !world.capabilities.has(extension)) {
        declaration.problems.push_back(
            {"method", fmt::format("needs {}, which this context lacks", extension), true});
        return declaration;
    }
    const bool empty = world.facts.triangles == 0 || !hasExtent(world.facts.sphere, resolution);
    declaration.outputs = {
        {.port = "occupancy", .desc = Desc::buffer(occupancyBytes(resolution), Format::R32UI)},
        {.port = "grid", .desc = Desc::buffer(sizeof(shared::OccupancyGrid))}};
    declaration.steps = {{.name = "grid",
                          .run = &OccupancyMap::uploadGrid,
                          .uses = {{.port = "grid", .access = Access::Copy, .write = true}},
                          .group = "generation"}};
    if (jitter) declaration.depends |= Causes::Frame;
    Output& occupancy = declaration.outputs.front();
    if (empty) {
        occupancy.constant = glm::vec4(0);
        declaration.leftOut.push_back({"marking of cells", "the scene has no triangle with an extent"});
        return declaration;
    }
    if (!demand.reads("occupancy")) return declaration;

    declaration.depends |= Causes::Geometry | Causes::Transforms;
    if (world.facts.hasMasked)
        declaration.depends |= Causes::Materials;
    else
        declaration.leftOut.push_back({"alpha test", "no material is masked or blended"});
    if (!makesColumns(method)) occupancy.clear = glm::vec4(0);
    std::vector<Step> steps = method == OccupancyMethod::Exact ? exactSteps(world, resolution)
                              : method == OccupancyMethod::Separating
                                  ? separatingSteps(world, resolution, inset)
                              : makesColumns(method) ? columnSteps(world)
                                                     : rasterSteps(world);
    for (const Step& step : steps) declareInternals(step, world, declaration);
    std::move(steps.begin(), steps.end(), std::back_inserter(declaration.steps));
    return declaration;
}

// The columns and lists that a step writes first.
void OccupancyMap::declareInternals(const Step& step, const World& world, Declaration& declaration) const {
    const Extent face{static_cast<std::uint32_t>(resolution), static_cast<std::uint32_t>(resolution), 1};
    for (const Use& use : step.uses) {
        if (!use.write || use.port == "occupancy") continue;
        const Desc desc =
            use.port == "large" ? largeTrianglesDesc(world) : Desc::texture2D(Format::RGBA32UI, face);
        const bool known = std::any_of(declaration.outputs.begin(), declaration.outputs.end(),
                                       [&](const Output& output) { return output.port == use.port; });
        if (!known) declaration.outputs.push_back({.port = use.port, .desc = desc, .clear = glm::vec4(0)});
    }
}

std::vector<Step> OccupancyMap::rasterSteps(const World& world) const {
    const int lastAxis = method == OccupancyMethod::DominantAxis ? 0 : 2; // a shader chooses the face itself
    Step step{.name = "rasterize",
              .run = {&OccupancyMap::rasterizeAlong, 0, lastAxis},
              .shaders = {"occupancy/raster.vert", "occupancy/raster.frag"},
              .defines = markingDefines(world, resolution),
              .uses = {{.port = "grid", .access = Access::Uniform},
                       {.port = "occupancy", .access = Access::Storage, .write = true}},
              .group = "generation"};
    step.defines.emplace("INTO_MAP", "1");
    if (method == OccupancyMethod::DominantAxis) {
        step.defines.emplace("FACE_BY_TRIANGLE", "1");
        step.shaders.emplace_back("occupancy/raster.geom");
    }
    return {step};
}

std::vector<Step> OccupancyMap::columnSteps(const World& world) const {
    const bool attachments = method != OccupancyMethod::Interlock;
    const bool high = resolution > 128;
    std::vector<Step> steps;
    const auto n = static_cast<std::uint32_t>(resolution);
    Step merge{.name = "merge",
               .run = [n](Commands& commands) { commands.dispatchOver(n, n, n / 32); },
               .shaders = {"occupancy/merge.comp"},
               .defines = {{"RESOLUTION", std::to_string(resolution)}},
               .uses = {{.port = "occupancy", .access = Access::Storage, .write = true}},
               .group = "generation"};
    for (int axis = 0; axis < 3; ++axis) {
        Step step{.name = fmt::format("rasterize_{}", "xyz"[axis]),
                  .run = {&OccupancyMap::rasterizeAlong, axis, axis},
                  .shaders = {"occupancy/raster.vert", "occupancy/raster.frag"},
                  .defines = markingDefines(world, resolution),
                  .uses = {{.port = "grid", .access = Access::Uniform}},
                  .group = "generation"};
        step.defines.emplace("INTO_COLUMNS", "1");
        if (method == OccupancyMethod::Interlock) step.defines.emplace("BY_INTERLOCK", "1");
        if (method == OccupancyMethod::FramebufferFetch) step.defines.emplace("BY_FETCH", "1");
        for (int half = 0; half < (high ? 2 : 1); ++half) {
            const std::string port = half == 0 ? axisPorts[axis] : highAxisPorts[axis];
            step.uses.push_back(
                {.port = port, .access = attachments ? Access::Attachment : Access::Image, .write = true});
            step.defines[half == 0 ? "COLUMNS_LOW" : "COLUMNS_HIGH"] = (attachments ? "out_" : "") + port;
            merge.uses.push_back({.port = port, .access = Access::Image});
        }
        steps.push_back(std::move(step));
    }
    steps.push_back(std::move(merge));
    return steps;
}

void OccupancyMap::rasterizeAlong(Commands& commands, int firstAxis, int lastAxis) const {
    for (int axis = firstAxis; axis <= lastAxis; ++axis) {
        if (method != OccupancyMethod::DominantAxis) commands.set("axis", axis);
        rasterize(commands);
    }
}

// A surface with two sides has none to be marked behind.
void OccupancyMap::rasterize(Commands& commands) const {
    DrawState state = DrawState::overwrite();
    state.viewport = glm::uvec2(static_cast<unsigned>(resolution));
    state.logicOr = method == OccupancyMethod::LogicOp;
    commands.set("inset", inset);
    commands.drawScene(state, oneSidedClasses);
    commands.set("inset", 0.0f);
    commands.drawScene(state, doubleSidedClasses);
}

void OccupancyMap::uploadGrid(Commands& commands) const {
    glm::vec3 shift(0);
    if (jitter) {
        const FrameInfo& frame = commands.frame();
        const std::uint32_t seed = shared::pixelSeed({0, 0}, shared::randomGridJitter, frame.seed);
        const glm::vec2 plane = shared::scrambledSobol(frame.index, seed);
        const glm::vec2 height = shared::scrambledSobol(frame.index, shared::hashCombine(seed, 1));
        shift = glm::vec3(plane, height.x) - 0.5f;
    }
    commands.uploadValue("grid",
                         occupancyGrid(commands.facts().sphere, commands.facts().bounds, resolution, shift));
}

} // namespace kestrel
