#include "reference_ray_query.h"
#include "execute/commands.h"
#include "reference/rows.h"
#include <algorithm>
#include <cstring>

namespace kestrel {
namespace {

// Rays a thread takes at once: whole packets, few enough that both threads end together.
constexpr size_t raysPerBatch = 256 * tracePacket;

// As in Bvh.
TraceRay traceRay(const shared::RayRecord& record) {
    return {.origin = shared::offFace(record.origin, record.normal),
            .direction = record.direction,
            .tMin = record.tMin,
            .tMax = record.tMax};
}

} // namespace

PassType ReferenceRayQuery::type() {
    return Describe<ReferenceRayQuery>("ReferenceRayQuery",
                                       "Traces a buffer of rays by Embree on the CPU, in packets: the truth")
        .input("rays", PortKind::Buffer, "Ray records (shared/ray.h)")
        .carries(content::elements("RayRecord"))
        .output("hits", PortKind::Buffer, "One hit record a ray (shared/ray.h)")
        .carries(content::elements("HitRecord"))
        .choice("query", &ReferenceRayQuery::query, {"any", "closest"},
                "Is anything there, or what is nearest?")
        .choice("build", &ReferenceRayQuery::build, {"low", "medium", "high"},
                "Of Embree's hierarchy: built fast, as usual, or for fast tracing")
        .number("threads", &ReferenceRayQuery::threads, 1, 256, "threads", "Of the CPU");
}

Declaration ReferenceRayQuery::declare(const World&, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const std::uint64_t count = inputs["rays"].desc.bytes / sizeof(shared::RayRecord);
    declaration.outputs.push_back({.port = "hits", .desc = Desc::buffer(count * sizeof(shared::HitRecord))});
    const auto step = [&](const char* name, StepRun run, std::vector<Use> uses, const char* group) {
        declaration.steps.push_back(
            {.name = name, .run = std::move(run), .uses = std::move(uses), .group = group});
    };
    step("build", &ReferenceRayQuery::buildHierarchy, {}, "generation");
    step("take", &ReferenceRayQuery::take, {{.port = "rays", .access = Access::Host}}, "transfer");
    step("trace", &ReferenceRayQuery::trace, {}, "tracing");
    step("give", &ReferenceRayQuery::give, {{.port = "hits", .access = Access::Copy, .write = true}},
         "transfer");
    declaration.depends = Causes::Geometry | Causes::Transforms | Causes::Materials | Causes::Properties;
    return declaration;
}

void ReferenceRayQuery::buildHierarchy(Commands& commands) {
    constexpr Causes scene = Causes::Geometry | Causes::Transforms | Causes::Materials;
    if (!tracer_ || built_ != build || any(commands.causes() & scene)) {
        tracer_.emplace(commands.geometry(), commands.scene(), true, build);
        built_ = build;
    }
    commands.report("build of the hierarchy alone, ms", tracer_->buildMs());
}

void ReferenceRayQuery::take(Commands& commands) {
    const std::vector<std::byte> bytes = commands.download("rays");
    std::vector<shared::RayRecord> records(bytes.size() / sizeof(shared::RayRecord));
    std::memcpy(records.data(), bytes.data(), records.size() * sizeof(shared::RayRecord));
    rays_.clear();
    records_.clear();
    hits_.resize(records.size());
    for (size_t i = 0; i < records.size(); ++i) {
        hits_[i] = {};
        hits_[i].t = std::numeric_limits<float>::infinity();
        hits_[i].weight = 1;
        hits_[i].direction = records[i].direction;
        if ((records[i].flags & 1u) == 0) continue;
        rays_.push_back(traceRay(records[i]));
        records_.push_back(static_cast<std::uint32_t>(i));
    }
    any_.assign(rays_.size(), 0);
    closest_.assign(rays_.size(), {});
}

void ReferenceRayQuery::trace(Commands&) {
    const size_t batches = (rays_.size() + raysPerBatch - 1) / raysPerBatch;
    forEachRow(static_cast<int>(batches), threads, [&](int batch) {
        const size_t first = static_cast<size_t>(batch) * raysPerBatch;
        const size_t count = std::min(raysPerBatch, rays_.size() - first);
        const std::span<const TraceRay> rays(rays_.data() + first, count);
        if (query == Query::Any)
            tracer_->anyHits(rays, std::span(any_.data() + first, count));
        else
            tracer_->closestHits(rays, std::span(closest_.data() + first, count), false);
    });
}

void ReferenceRayQuery::give(Commands& commands) {
    for (size_t i = 0; i < rays_.size(); ++i) {
        shared::HitRecord& hit = hits_[records_[i]];
        if (query == Query::Any) {
            if (any_[i] != 0) hit.t = 0;
        } else if (closest_[i].triangle != TraceHit::none) {
            hit.t = closest_[i].t;
            hit.idX = closest_[i].triangle;
        }
    }
    commands.upload("hits", hits_);
    commands.report("rays", static_cast<double>(rays_.size()));
}

} // namespace kestrel
