// A buffer of rays through Embree into a buffer of hits: what RayQuery is measured against, ray by ray and in
// time.
#pragma once
#include "graph/registry.h"
#include "reference/tracer.h"
#include "shared/ray.h"
#include <optional>
#include <vector>

namespace kestrel {

// Its steps are timed apart: `build` makes Embree's hierarchy (group "generation"), `take` reads the rays
// back and `give` uploads the hits (group "transfer"), `trace` is the tracing in packets alone (group
// "tracing").
class ReferenceRayQuery final : public Pass {
public:
    enum class Query { Any, Closest };

    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    Query query = Query::Any;
    BuildQuality build = BuildQuality::Medium;
    int threads = 2;

private:
    void buildHierarchy(Commands& commands);
    void take(Commands& commands);
    void trace(Commands& commands);
    void give(Commands& commands);

    std::optional<ReferenceTracer> tracer_;
    BuildQuality built_ = BuildQuality::Medium; // of it
    std::vector<TraceRay> rays_;                // that exist
    std::vector<std::uint32_t> records_;        // which record each of them is
    std::vector<std::uint8_t> any_;
    std::vector<TraceHit> closest_;
    std::vector<shared::HitRecord> hits_;
};

} // namespace kestrel
