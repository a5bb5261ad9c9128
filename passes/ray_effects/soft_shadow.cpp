#include "soft_shadow.h"
#include "draw/face_input.h"
#include "draw/no_light.h"
#include "draw/ray_steps.h"
#include "execute/commands.h"
#include "shared/emitter.h"
#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <limits>

namespace kestrel {
namespace {

// How many emissive triangles there are is known only once there are triangles; more make the buffer grow.
constexpr std::uint64_t firstEmissiveTriangles = 1024;

std::uint64_t emitterCapacity(const World& world, const Demand& demand, bool emission) {
    std::uint64_t count = std::uint64_t{world.facts.rectangleLights} + world.facts.sphereLights;
    if (emission && world.facts.hasEmission) count += std::min(world.facts.triangles, firstEmissiveTriangles);
    return std::max({std::uint64_t{1}, count, demand.grown("emitters")});
}

shared::EmitterRecord recordOfEmitter(const AreaEmitter& emitter) {
    shared::EmitterRecord record{};
    const bool sphere = emitter.kind == AreaEmitter::Kind::Sphere;
    record.corner = emitter.corner;
    record.kind = sphere                                        ? shared::emitterSphere
                  : emitter.kind == AreaEmitter::Kind::Triangle ? shared::emitterTriangle
                                                                : shared::emitterParallelogram;
    record.u = emitter.u;
    record.upper = emitter.upper;
    record.v = emitter.v;
    record.probability = emitter.probability;
    record.radiance = emitter.radiance;
    record.bothSides = emitter.bothSides ? 1.0f : 0.0f;
    return record;
}

} // namespace

PassType SoftShadow::type() {
    Describe<SoftShadow> table(
        "SoftShadow",
        "Light straight from area lights and emissive meshes, by shadow rays through any tracer");
    return addSurface(table)
        .input("tracer", PortKind::Tracer, "Who answers the visibility queries")
        .output("result", PortKind::Texture, "Irradiance over pi that arrives; 0 where nothing is")
        .carries(content::colour)
        .range(0, std::numeric_limits<double>::infinity())
        .output("visibility", PortKind::Texture,
                "How bright the result is over what it would be without shadows; 1 where no light reaches")
        .carries({.channels = 1})
        .range(0, 1)
        .output(
            "weight", PortKind::Texture,
            "How bright the result would be without shadows: what this frame's visibility counts in a mean")
        .carries({.channels = 1})
        .range(0, std::numeric_limits<double>::infinity())
        .internal("emitters", PortKind::Buffer, "What shines (shared/emitter.h)")
        .number("rays", &SoftShadow::rays, 1, 256, "rays",
                "Rays a pixel and frame, for all emitters together")
        .flag("emission", &SoftShadow::emission,
              "Emissive meshes shine too, but for those that only show where an area light is")
        .flag("snap", &SoftShadow::snap,
              "Bears that a tracer replaces directions by nearby ones: faster, and shadows fall wrongly");
}

Declaration SoftShadow::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const Desc& depth = inputs["depth"].desc;
    const bool meshes = emission && world.facts.hasEmission;
    const bool rectangles = world.facts.rectangleLights > 0, spheres = world.facts.sphereLights > 0;
    const bool background = inputs["depth"].constant == glm::vec4(0);
    const bool dark = !meshes && !rectangles && !spheres;
    Output result{.port = "result", .desc = Desc::texture2D(Format::RGBA32F, depth.extent, depth.view)};
    Output visibility{.port = "visibility", .desc = Desc::texture2D(Format::R32F, depth.extent, depth.view)};
    Output weight{.port = "weight", .desc = Desc::texture2D(Format::R32F, depth.extent, depth.view)};
    if (background || dark) {
        result.constant = noLight;
        visibility.constant = glm::vec4(1);
        weight.constant = glm::vec4(0);
        declaration.outputs = {std::move(result), std::move(visibility), std::move(weight)};
        declaration.leftOut.push_back(
            {"shadow rays", background ? "the depth is empty everywhere"
                            : emission ? "the scene has no area light and no material emits light"
                                       : "the scene has no area light, and emission is off"});
        return declaration;
    }
    const bool tellsVisibility = demand.reads("visibility"), tellsWeight = demand.reads("weight");
    const std::uint64_t capacity = emitterCapacity(world, demand, meshes);
    const auto limit = static_cast<std::uint64_t>(world.capabilities.maxTextureBufferTexels);
    if (capacity * shared::emitterRecordTexels > limit)
        declaration.problems.push_back(
            {"emitters",
             fmt::format("{} emitters need {} texels in a buffer texture; the limit is {}", capacity,
                         capacity * shared::emitterRecordTexels, limit),
             true});
    declaration.outputs.push_back(std::move(result));
    if (tellsVisibility) declaration.outputs.push_back(std::move(visibility));
    if (tellsWeight) declaration.outputs.push_back(std::move(weight));
    declaration.outputs.push_back(
        {.port = "emitters",
         .desc = Desc::buffer(capacity * sizeof(shared::EmitterRecord), Format::RGBA32F)});
    if (!meshes)
        declaration.leftOut.push_back(
            {"emissive meshes", emission ? "no material emits light" : "emission is off"});
    if (!spheres) declaration.leftOut.push_back({"sphere lights", "the scene has none"});

    declaration.steps.push_back({.name = "emitters",
                                 .run = &SoftShadow::upload,
                                 .uses = {{.port = "emitters", .access = Access::Copy, .write = true}},
                                 .group = "generation"});
    // A proxy's hit may be the light's own surface, which only the distance tells.
    const bool approximate = (inputs["tracer"].desc.provides & provides::Approximate) != 0;
    Step step{.run = &SoftShadow::trace,
              .shaders = {"ray_effects/soft_shadow.comp"},
              .uses = {{.port = "depth", .access = Access::Fetch},
                       {.port = "normal", .access = Access::Fetch},
                       {.port = "emitters", .access = Access::Image},
                       {.port = "result", .access = Access::Image, .write = true}},
              .modules = {{"tracer", (approximate ? requests::ClosestHit : requests::AnyHit) |
                                         (snap ? requests::Snap : 0)}}};
    if (meshes || rectangles) step.defines.emplace("FLAT_EMITTERS", "1");
    if (spheres) step.defines.emplace("SPHERE_EMITTERS", "1");
    if (approximate) step.defines.emplace("APPROXIMATE", "1");
    useFaceNormal(declaration, step, inputs);
    std::vector<Step> steps = raySteps(std::move(step), rays, inputs["tracer"].desc, world.facts);
    if (tellsVisibility) { // of the sums of all steps
        steps.back().defines.emplace("VISIBILITY", "1");
        steps.back().uses.push_back({.port = "visibility", .access = Access::Image, .write = true});
    }
    if (tellsWeight) {
        steps.back().defines.emplace("WEIGHT", "1");
        steps.back().uses.push_back({.port = "weight", .access = Access::Image, .write = true});
    }
    std::move(steps.begin(), steps.end(), std::back_inserter(declaration.steps));
    declaration.depends = Causes::Frame | Causes::Geometry | Causes::Transforms | Causes::Materials |
                          Causes::Lights | Causes::Properties;
    return declaration;
}

void SoftShadow::trace(Commands& commands) const {
    commands.set("emitterCount", static_cast<std::uint32_t>(emitters_.size()));
    commands.dispatchOver(commands.desc("result").extent);
}

void SoftShadow::upload(Commands& commands) {
    if (any(commands.causes() & ~(Causes::Frame | Causes::Camera)))
        emitters_ = areaEmitters(commands.lights(), commands.geometry(), commands.scene(), emission);
    if (emitters_.size() * sizeof(shared::EmitterRecord) > commands.desc("emitters").bytes)
        return commands.overflow("emitters", emitters_.size());
    std::vector<shared::EmitterRecord> records;
    for (const AreaEmitter& emitter : emitters_) records.push_back(recordOfEmitter(emitter));
    // Wholly written: memory that other buffers had before may hold anything.
    records.resize(commands.desc("emitters").bytes / sizeof(shared::EmitterRecord));
    commands.upload("emitters", records);
}

} // namespace kestrel
