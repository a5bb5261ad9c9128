#include "distance_field.h"
#include "execute/commands.h"
#include "shared/distance_field.h"
#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace kestrel {
namespace {

static_assert(sizeof(shared::DistanceFieldSettings) == 32);

// Cells along an edge of an occupancy map (shared/occupancy.h), by its size and texels.
std::optional<int> mapResolution(const Desc& map) {
    if (map.kind != ResourceKind::Buffer || map.format != Format::R32UI) return std::nullopt;
    for (const std::uint64_t n : {32, 64, 128, 256})
        if (map.bytes == n * n * n / 8) return static_cast<int>(n);
    return std::nullopt;
}

Desc volume(Format format, int resolution, int mips = 1) {
    const auto n = static_cast<std::uint32_t>(resolution);
    return Desc::texture3D(format, {n, n, n}, mips);
}

// A step that makes something of the field from the map or from what earlier steps made of it.
// A step over `cells` invocations along x, y and z.
Step generation(std::string name, std::string shader, int resolution, glm::ivec3 cells) {
    return {.name = std::move(name),
            .run = [cells = glm::uvec3(cells)](
                       Commands& commands) { commands.dispatchOver(cells.x, cells.y, cells.z); },
            .shaders = {std::move(shader)},
            .defines = {{"RESOLUTION", std::to_string(resolution)}},
            .group = "generation"};
}

void readMap(Step& step, Access access) {
    if (access == Access::Storage) step.defines.emplace("BASE_STORAGE", "1");
    step.uses.push_back({.port = "occupancy", .access = access});
}

} // namespace

PassType DistanceField::type() {
    return Describe<DistanceField>("DistanceField",
                                   "Distances to the occupied cells of a map, traced by spheres")
        .input("occupancy", PortKind::Buffer, "Base occupancy map")
        .carries(content::elements("OccupancyWord"))
        .input("grid", PortKind::Buffer, "Where its cells lie")
        .carries(content::elements("OccupancyGrid"))
        .output("tracer", PortKind::Tracer, "Sphere-traces the field")
        .internal("field", PortKind::Texture, "Distance to the nearest occupied cell's centre, in cells")
        .internal("seeds_a", PortKind::Texture, "Nearest known seeds of jump flooding, every other round")
        .internal("seeds_b", PortKind::Texture, "Those of the rounds between")
        .internal("planes", PortKind::Texture, "Squared distances within planes of constant x")
        .internal("settings", PortKind::Buffer, "How rays are marched (shared/distance_field.h)")
        .choice("method", &DistanceField::method, {"jump_flooding", "exact"},
                "How the field is made: 3D jump flooding, or an exact separable distance transform")
        .number("mips", &DistanceField::mips, 1, 5, "levels", "Levels of the field, each half as fine")
        .number("iterations", &DistanceField::iterations, 1, 1024, "samples",
                "How often a ray may sample the field; then it counts as unoccluded")
        .number("threshold", &DistanceField::threshold, 0.01, 4, "cells",
                "How near a ray must come to an occupied cell's centre to hit it")
        .number("offset", &DistanceField::offset, 0, 8, "cells",
                "How far ray origins are moved off the surface, along its normal")
        .number("skip", &DistanceField::skip, 0, 8, "cells",
                "How far rays from a surface go before anything counts")
        .number("scale", &DistanceField::scale, 0.1, 2, "", "Length of a step over the distance found")
        .number("least_step", &DistanceField::leastStep, 0.01, 4, "cells", "The shortest step")
        .choice("level", &DistanceField::level, {"step", "travelled"},
                "Which level a ray samples: the coarsest that its last step allows, or one that coarsens "
                "with the distance travelled")
        .number("margin", &DistanceField::margin, 0.5, 8, "cells of a level",
                "With level step: how far away everything must be for a level to be sampled")
        .number("widening", &DistanceField::widening, 0, 1, "",
                "With level travelled: width of a ray over its length; the level's cells are no wider");
}

Declaration DistanceField::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const Desc& base = inputs["occupancy"].desc;
    const std::optional<int> resolution = mapResolution(base);
    if (!resolution) {
        declaration.problems.push_back(
            {"occupancy",
             fmt::format("is no occupancy map of 32, 64, 128 or 256 cells an edge: {}", describe(base))});
        return declaration;
    }
    declaration.outputs = {{.port = "tracer", .desc = Desc::module(provides::Approximate)}};
    if (!demand.reads("tracer")) return declaration;

    Module tracer{.port = "tracer", .shader = "distance_field/distance_field.glsl"};
    if (inputs["occupancy"].constant == glm::vec4(0)) {
        tracer.defines.emplace("EMPTY", "1");
        declaration.leftOut.push_back({"distance field", "the occupancy map is empty"});
        declaration.modules.push_back(std::move(tracer));
        return declaration;
    }
    tracer.defines = {{"RESOLUTION", std::to_string(*resolution)},
                      {"LEVELS", std::to_string(mips)},
                      {"ITERATIONS", std::to_string(iterations)}};
    if (level == LevelChoice::Travelled) tracer.defines.emplace("BY_TRAVEL", "1");
    tracer.uses = {{.port = "grid", .access = Access::Uniform},
                   {.port = "settings", .access = Access::Uniform},
                   {.port = "field", .access = Access::Fetch, .linear = true}};
    declaration.modules.push_back(std::move(tracer));
    declaration.outputs.push_back({.port = "field", .desc = volume(Format::R16F, *resolution, mips)});
    declaration.outputs.push_back(
        {.port = "settings", .desc = Desc::buffer(sizeof(shared::DistanceFieldSettings))});

    // Random reads go through image units where the texels fit a texture buffer (shared/occupancy.h).
    const auto texels = static_cast<std::uint64_t>(world.capabilities.maxTextureBufferTexels);
    const Access access = base.bytes / 4 <= texels ? Access::Image : Access::Storage;
    if (method == DistanceMethod::JumpFlooding) {
        declaration.outputs.push_back({.port = "seeds_a", .desc = volume(Format::R32UI, *resolution)});
        declaration.outputs.push_back({.port = "seeds_b", .desc = volume(Format::R32UI, *resolution)});
        declaration.steps = floodSteps(*resolution, access);
    } else {
        declaration.outputs.push_back({.port = "planes", .desc = volume(Format::R32F, *resolution)});
        declaration.steps = exactSteps(*resolution, access);
    }
    for (int mip = 1; mip < mips; ++mip) {
        Step step = generation(fmt::format("level{}", mip), "distance_field/coarser.comp", *resolution,
                               glm::ivec3(*resolution >> mip));
        step.uses = {{.port = "field", .access = Access::Image, .mip = mip - 1},
                     {.port = "field", .access = Access::Image, .write = true, .mip = mip}};
        declaration.steps.push_back(std::move(step));
    }
    declaration.steps.push_back({.name = "settings",
                                 .run = &DistanceField::uploadSettings,
                                 .uses = {{.port = "settings", .access = Access::Copy, .write = true}},
                                 .group = "generation"});
    declaration.depends = Causes::Properties;
    return declaration;
}

std::vector<Step> DistanceField::floodSteps(int resolution, Access base) const {
    std::vector<Step> steps;
    std::string from, to = "seeds_a";
    for (int stride = resolution / 2; stride >= 1; stride /= 2) {
        Step step = generation(fmt::format("flood{}", stride), "distance_field/jump_flood.comp", resolution,
                               glm::ivec3(resolution));
        step.defines.emplace("STRIDE", std::to_string(stride));
        if (from.empty()) {
            step.defines.emplace("FIRST", "1");
            readMap(step, base);
        } else {
            step.defines.emplace("FROM", from);
            step.uses.push_back({.port = from, .access = Access::Image});
        }
        if (stride == 1) {
            step.defines.emplace("LAST", "1");
            step.uses.push_back({.port = "field", .access = Access::Image, .write = true, .mip = 0});
        } else {
            step.defines.emplace("TO", to);
            step.uses.push_back({.port = to, .access = Access::Image, .write = true});
        }
        steps.push_back(std::move(step));
        from = to;
        to = from == "seeds_a" ? "seeds_b" : "seeds_a";
    }
    return steps;
}

std::vector<Step> DistanceField::exactSteps(int resolution, Access base) const {
    Step columns =
        generation("along_y", "distance_field/envelope.comp", resolution, {resolution, resolution, 1});
    columns.defines.emplace("ALONG_Y", "1");
    readMap(columns, base);
    columns.uses.push_back({.port = "planes", .access = Access::Image, .write = true});
    Step rows =
        generation("along_x", "distance_field/envelope.comp", resolution, {resolution, resolution, 1});
    rows.uses = {{.port = "planes", .access = Access::Image},
                 {.port = "field", .access = Access::Image, .write = true, .mip = 0}};
    return {columns, rows};
}

void DistanceField::uploadSettings(Commands& commands) const {
    commands.uploadValue("settings", shared::DistanceFieldSettings{threshold, offset, skip, scale, leastStep,
                                                                   margin, widening, 0});
}

} // namespace kestrel
