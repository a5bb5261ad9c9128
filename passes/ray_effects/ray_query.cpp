#include "ray_query.h"
#include "draw/material_defines.h"
#include "execute/commands.h"
#include "graph/many_rays.h"
#include "shared/ray.h"
#include <algorithm>

namespace kestrel {
namespace {
// A dispatch may have 65,535 groups an axis at least, so rays are laid out in rows of this many groups.
constexpr std::uint32_t groupSize = 64;
constexpr std::uint32_t groupsPerRow = 32768;
// That an invocation traces where the tracer takes many: enough that a lane seldom waits for others, few
// enough that the loops of all together stay below what drivers allow (lib/iterations.glsl). A walk to what
// is nearest passes all that lies one upon another.
constexpr std::uint32_t anyTogether = 32;
constexpr std::uint32_t closestTogether = 16;
} // namespace

PassType RayQuery::type() {
    return Describe<RayQuery>("RayQuery", "Traces a buffer of rays through any tracer into a buffer of hits")
        .input("rays", PortKind::Buffer, "Ray records (shared/ray.h)")
        .carries(content::elements("RayRecord"))
        .input("tracer", PortKind::Tracer, "Who answers")
        .output("hits", PortKind::Buffer, "One hit record a ray (shared/ray.h)")
        .carries(content::elements("HitRecord"))
        .output("distance", PortKind::Buffer,
                "One float a ray, as HitRecord::t: for those who need no more, in half the time")
        .carries(content::elements("float"))
        .choice("query", &RayQuery::query, {"any", "closest"}, "Is anything there, or what is nearest?")
        .flag("snap", &RayQuery::snap, "Bears that a tracer replaces directions by nearby ones");
}

std::uint64_t RayQuery::rayCount(const Desc& rays) { return rays.bytes / sizeof(shared::RayRecord); }

Declaration RayQuery::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const Desc& rays = inputs["rays"].desc;
    const std::uint64_t count = rayCount(rays);
    Step step{.name = "trace",
              .shaders = {"ray_effects/ray_query.comp"},
              .defines = {{"GROUP_SIZE", std::to_string(groupSize)},
                          {"GROUPS_PER_ROW", std::to_string(groupsPerRow)}},
              .modules = {{"tracer", (query == Query::Any ? requests::AnyHit : requests::ClosestHit) |
                                         (snap ? requests::Snap : 0)}},
              .group = "tracing"};
    step.defines.merge(materialDefines(world.facts));
    if (query == Query::Closest) step.defines.emplace("CLOSEST", "1");
    // Whole texels, where the buffer allows it: a CPU driver fetches the members of a record one by one.
    const bool texels =
        rays.format == Format::RGBA32UI &&
        rays.bytes / 16 <= static_cast<std::uint64_t>(world.capabilities.maxTextureBufferTexels);
    if (!texels) step.defines.emplace("RAYS_STORAGE", "1");
    // What a snapped ray was replaced by is told ray by ray.
    const Bits given = inputs["tracer"].desc.provides;
    const bool snaps = snap && (given & (provides::Snaps | provides::AlwaysSnaps)) != 0;
    const bool any = query == Query::Any;
    if (texels && !snaps && (given & (any ? provides::ManyRays : provides::ManyClosest)) != 0) {
        step.modules = {{"tracer", any ? requests::ManyRays : requests::ManyClosest}};
        step.defines.emplace("RAYS", std::to_string(any ? anyTogether : closestTogether));
    }
    step.uses.push_back({.port = "rays", .access = texels ? Access::Image : Access::Storage});
    const auto give = [&](const char* port, const char* define, std::uint64_t bytes) {
        if (!demand.reads(port)) return;
        declaration.outputs.push_back({.port = port, .desc = Desc::buffer(count * bytes)});
        step.defines.emplace(define, "1");
        step.uses.push_back({.port = port, .access = Access::Storage, .write = true});
    };
    give("hits", "HITS", sizeof(shared::HitRecord));
    give("distance", "DISTANCES", sizeof(float));
    if (declaration.outputs.empty()) return declaration;
    declaration.steps.push_back(std::move(step));
    declaration.depends = Causes::Properties;
    return declaration;
}

void RayQuery::execute(const Step& step, Commands& commands) {
    const auto count = static_cast<std::uint32_t>(rayCount(commands.desc("rays")));
    const std::uint32_t together = query == Query::Any ? anyTogether : closestTogether;
    const std::uint32_t perGroup = groupSize * (step.defines.contains("RAYS") ? together : 1);
    const std::uint32_t groups = (count + perGroup - 1) / perGroup;
    commands.dispatch(std::min(groups, groupsPerRow), (groups + groupsPerRow - 1) / groupsPerRow);
}

} // namespace kestrel
