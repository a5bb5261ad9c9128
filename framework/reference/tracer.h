// The reference ray tracer: Embree over a flattened scene, with alpha tests.
#pragma once
#include "scene/geometry.h"
#include "scene/trace.h"
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>

namespace kestrel {

// Rays that batches are traced in packets of.
inline constexpr int tracePacket = 16;

// How well Embree builds its hierarchy: fast for what moves each frame (Morton codes), as usual, or with
// triangles split between nodes.
enum class BuildQuality : std::uint8_t { Low, Medium, High };

// Traces the geometry that it was built from (in Embree's robust mode, both sides of every triangle). Of
// triangles with the same corners the lowest is met, whatever the processor. Points
// of masked and blended materials whose base colour alpha is below the cutoff let rays pass. All queries may
// be called from several threads at once.
class ReferenceTracer {
public:
    // Copies what it needs. `blendedAsMasked` false: blended materials stop rays wherever their alpha is
    // above 0. Throws MachineError if Embree is not built in or refuses.
    ReferenceTracer(const Geometry& geometry, const Scene& scene, bool blendedAsMasked = true,
                    BuildQuality quality = BuildQuality::Medium);
    ~ReferenceTracer();
    ReferenceTracer(ReferenceTracer&&) noexcept;
    ReferenceTracer& operator=(ReferenceTracer&&) noexcept;

    [[nodiscard]] std::optional<TraceHit> closestHit(const TraceRay& ray) const;
    [[nodiscard]] bool anyHit(const TraceRay& ray) const;
    // Hands every hit to `visit`, in no particular order, until that returns true. A surface is met once: an
    // edge or vertex that triangles share belongs to one of them (shaders/shared/triangle.h). Builds boxes of
    // its own when it is first called.
    void allHits(const TraceRay& ray, const std::function<bool(const TraceHit&)>& visit) const;

    // Whole batches in packets of tracePacket. `hits` is as long as `rays`; TraceHit::none where nothing was
    // hit. `coherent` says that neighbours in the batch run alike (camera rays).
    void closestHits(std::span<const TraceRay> rays, std::span<TraceHit> hits, bool coherent) const;
    // 1 where something was hit, else 0.
    void anyHits(std::span<const TraceRay> rays, std::span<std::uint8_t> hits) const;

    // How long Embree took for its hierarchy alone, of what the constructor took.
    [[nodiscard]] double buildMs() const;
    [[nodiscard]] const Box& bounds() const; // of the geometry, render space

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace kestrel
