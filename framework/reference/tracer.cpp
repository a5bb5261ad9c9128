#include "reference/tracer.h"
#include "core/check.h"
#include "core/error.h"
#ifdef KESTREL_HAS_EMBREE
#include "reference/alpha_test.h"
#include "reference/coincident.h"
#include "reference/embree.h"
#include "shared/triangle.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <limits>
#include <mutex>
#include <utility>
#endif

namespace kestrel {

#ifdef KESTREL_HAS_EMBREE
namespace {

// A handle of Embree's that is released at the end.
template<class Handle, void (*release)(Handle)>
class Owned {
public:
    explicit Owned(Handle handle)
        : handle_(handle) {}
    ~Owned() {
        if (handle_) release(handle_);
    }
    Owned(const Owned&) = delete;
    Owned& operator=(const Owned&) = delete;
    [[nodiscard]] Handle get() const { return handle_; }

private:
    Handle handle_;
};

using Device = Owned<RTCDevice, rtcReleaseDevice>;
using SceneHandle = Owned<RTCScene, rtcReleaseScene>;
using GeometryHandle = Owned<RTCGeometry, rtcReleaseGeometry>;
using BufferHandle = Owned<RTCBuffer, rtcReleaseBuffer>;

void throwIfFailed(RTCDevice device, const char* what) {
    const RTCError error = rtcGetDeviceError(device);
    if (error != RTC_ERROR_NONE)
        throw MachineError(fmt::format("Embree fails while {} (error {})", what, static_cast<int>(error)));
}

// Embree's context, followed by what a query for all hits needs.
struct AllHitsContext {
    embree::Context base;
    shared::TriangleRay ray;
    float tMin, tMax;
    const std::function<bool(const TraceHit&)>* visit;
    bool stopped;
};

void setRay(RTCRay& to, const TraceRay& ray) {
    to.org_x = ray.origin.x;
    to.org_y = ray.origin.y;
    to.org_z = ray.origin.z;
    to.tnear = ray.tMin;
    to.dir_x = ray.direction.x;
    to.dir_y = ray.direction.y;
    to.dir_z = ray.direction.z;
    to.tfar = ray.tMax;
    to.time = 0;
    to.mask = ~0u;
    to.id = 0;
    to.flags = 0;
}

void setRay(RTCRay16& to, int i, const TraceRay& ray) {
    to.org_x[i] = ray.origin.x;
    to.org_y[i] = ray.origin.y;
    to.org_z[i] = ray.origin.z;
    to.tnear[i] = ray.tMin;
    to.dir_x[i] = ray.direction.x;
    to.dir_y[i] = ray.direction.y;
    to.dir_z[i] = ray.direction.z;
    to.tfar[i] = ray.tMax;
    to.time[i] = 0;
    to.mask[i] = ~0u;
    to.id[i] = static_cast<unsigned>(i);
    to.flags[i] = 0;
}

// Fills a packet from rays[first] on; lanes without a ray are invalid and hold a copy of the first.
void fillPacket(RTCRay16& to, int* valid, std::span<const TraceRay> rays, size_t first) {
    for (int i = 0; i < tracePacket; ++i) {
        const size_t k = first + static_cast<size_t>(i);
        valid[i] = k < rays.size() ? -1 : 0;
        setRay(to, i, rays[k < rays.size() ? k : first]);
    }
}

} // namespace

struct ReferenceTracer::State {
    State(const Geometry& geometry, const Scene& scene, bool blendedAsMasked, BuildQuality quality)
        : alpha(geometry, scene, blendedAsMasked)
        , coincident(geometry)
        , positions(geometry.positions)
        , indices(geometry.indices)
        , bounds(geometry.bounds)
        , device(rtcNewDevice(nullptr))
        , handle(device.get() ? rtcNewScene(device.get()) : nullptr) {
        if (!handle.get()) throw MachineError("Embree gives no device");
        rtcSetSceneFlags(handle.get(), RTC_SCENE_FLAG_ROBUST);
        constexpr RTCBuildQuality qualities[] = {RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_MEDIUM,
                                                 RTC_BUILD_QUALITY_HIGH};
        rtcSetSceneBuildQuality(handle.get(), qualities[static_cast<int>(quality)]);
        if (geometry.triangleCount() > 0) attach(geometry);
        const auto begin = std::chrono::steady_clock::now();
        rtcCommitScene(handle.get());
        buildMs = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
        throwIfFailed(device.get(), "building");
    }

    // Two geometries over one vertex buffer, so that only the masked one pays for the alpha test.
    void attach(const Geometry& geometry) {
        const size_t bytes = geometry.positions.size() * sizeof(glm::vec3);
        // Embree reads 16 bytes from every vertex, also from the last.
        const BufferHandle vertices(rtcNewBuffer(device.get(), bytes + sizeof(float)));
        throwIfFailed(device.get(), "allocating");
        std::memcpy(rtcGetBufferData(vertices.get()), geometry.positions.data(), bytes);
        const std::uint32_t masked = firstMaskedTriangle(geometry);
        attachRange(geometry, vertices.get(), 0, masked);
        attachRange(geometry, vertices.get(), masked, geometry.triangleCount());
    }

    void attachRange(const Geometry& geometry, RTCBuffer vertices, std::uint32_t first, std::uint32_t last) {
        if (first == last) return;
        const GeometryHandle range(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
        rtcSetGeometryBuffer(range.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0,
                             sizeof(glm::vec3), geometry.positions.size());
        void* corners = rtcSetNewGeometryBuffer(range.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                3 * sizeof(std::uint32_t), last - first);
        throwIfFailed(device.get(), "allocating");
        std::memcpy(corners, &geometry.indices[3 * static_cast<size_t>(first)],
                    3 * sizeof(std::uint32_t) * (last - first));
        if (first == firstMaskedTriangle(geometry)) {
            rtcSetGeometryUserData(range.get(), this);
            rtcSetGeometryIntersectFilterFunction(range.get(), refuseTransparent);
            rtcSetGeometryOccludedFilterFunction(range.get(), refuseTransparent);
        }
        rtcCommitGeometry(range.get());
        const unsigned id = rtcAttachGeometry(handle.get(), range.get());
        KESTREL_CHECK_LT(id, 2u);
        firstTriangle[id] = first;
    }

    static void refuseTransparent(const RTCFilterFunctionNArguments* arguments) {
        const auto* self = static_cast<const State*>(arguments->geometryUserPtr);
        for (unsigned i = 0; i < arguments->N; ++i) {
            if (arguments->valid[i] == 0) continue;
            const unsigned id = RTCHitN_geomID(arguments->hit, arguments->N, i);
            const std::uint32_t triangle =
                self->firstTriangle[id] + RTCHitN_primID(arguments->hit, arguments->N, i);
            const float u = RTCHitN_u(arguments->hit, arguments->N, i);
            const float v = RTCHitN_v(arguments->hit, arguments->N, i);
            if (!self->alpha.isSolid(triangle, u, v)) arguments->valid[i] = 0;
        }
    }

    [[nodiscard]] TraceHit hitOf(unsigned geometry, unsigned primitive, float t, float u, float v) const {
        if (geometry == RTC_INVALID_GEOMETRY_ID) return {};
        return lowest({t, u, v, firstTriangle[geometry] + primitive});
    }

    // The same point of the lowest triangle there that is solid.
    [[nodiscard]] TraceHit lowest(const TraceHit& hit) const {
        if (coincident.none()) return hit;
        for (const std::uint32_t triangle : coincident.with(hit.triangle)) {
            if (triangle == hit.triangle) break;
            TraceHit other{hit.t, 0, 0, triangle};
            const float weights[3] = {1 - hit.u - hit.v, hit.u, hit.v};
            for (std::uint32_t k = 0; k < 3; ++k) {
                if (corner(triangle, 1) == corner(hit.triangle, k)) other.u = weights[k];
                if (corner(triangle, 2) == corner(hit.triangle, k)) other.v = weights[k];
            }
            if (alpha.isSolid(triangle, other.u, other.v)) return other;
        }
        return hit;
    }

    [[nodiscard]] const glm::vec3& corner(std::uint32_t triangle, std::uint32_t k) const {
        return positions[indices[3 * static_cast<size_t>(triangle) + k]];
    }

    // For queries for all hits: boxes of Embree's, each triangle tested by shared::intersectTriangle(), since
    // Embree hands both triangles of an edge to a filter, and which ones of a vertex is a matter of rounding.
    // Made when it is first asked for.
    RTCScene exact() const {
        std::call_once(exactOnce, [this] {
            exactHandle = std::make_unique<SceneHandle>(rtcNewScene(device.get()));
            if (!exactHandle->get()) throw MachineError("Embree gives no scene");
            rtcSetSceneFlags(exactHandle->get(), RTC_SCENE_FLAG_ROBUST);
            const GeometryHandle all(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_USER));
            rtcSetGeometryUserPrimitiveCount(all.get(), static_cast<unsigned>(indices.size() / 3));
            rtcSetGeometryUserData(all.get(), const_cast<State*>(this));
            rtcSetGeometryBoundsFunction(all.get(), boundsOf, nullptr);
            rtcSetGeometryIntersectFunction(all.get(), meet);
            rtcCommitGeometry(all.get());
            rtcAttachGeometry(exactHandle->get(), all.get());
            rtcCommitScene(exactHandle->get());
            throwIfFailed(device.get(), "building");
        });
        return exactHandle->get();
    }

    // Wider by more than rounding can move a triangle's edge for a ray from anywhere near the scene; what is
    // hit is for the triangle's test to say.
    static void boundsOf(const RTCBoundsFunctionArguments* arguments) {
        const auto* self = static_cast<const State*>(arguments->geometryUserPtr);
        Box box;
        for (std::uint32_t k = 0; k < 3; ++k) box.add(self->corner(arguments->primID, k));
        const glm::vec3 far = glm::max(glm::abs(self->bounds.min), glm::abs(self->bounds.max));
        const float room = 2e-6f * (std::max({far.x, far.y, far.z}) + glm::length(self->bounds.size()));
        RTCBounds& out = *arguments->bounds_o;
        out.lower_x = box.min.x - room;
        out.lower_y = box.min.y - room;
        out.lower_z = box.min.z - room;
        out.upper_x = box.max.x + room;
        out.upper_y = box.max.y + room;
        out.upper_z = box.max.z + room;
    }

    static void meet(const RTCIntersectFunctionNArguments* arguments) {
        const auto* self = static_cast<const State*>(arguments->geometryUserPtr);
        auto* all = reinterpret_cast<AllHitsContext*>(arguments->context);
        const std::uint32_t triangle = arguments->primID;
        shared::TriangleHit hit{};
        if (arguments->valid[0] == 0 || all->stopped ||
            !shared::intersectTriangle(all->ray, all->tMin, all->tMax, self->corner(triangle, 0),
                                       self->corner(triangle, 1), self->corner(triangle, 2), hit) ||
            !self->alpha.isSolid(triangle, hit.u, hit.v))
            return;
        all->stopped = (*all->visit)({hit.t, hit.u, hit.v, triangle});
        // Nothing is nearer: Embree ends.
        if (all->stopped)
            RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, arguments->N), arguments->N, 0) =
                -std::numeric_limits<float>::infinity();
    }

    AlphaTest alpha;
    CoincidentTriangles coincident;
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
    mutable std::once_flag exactOnce;
    Box bounds;
    double buildMs = 0;
    std::uint32_t firstTriangle[2] = {0, 0}; // of each Embree geometry
    Device device;
    SceneHandle handle;
    mutable std::unique_ptr<SceneHandle> exactHandle;
};

ReferenceTracer::ReferenceTracer(const Geometry& geometry, const Scene& scene, bool blendedAsMasked,
                                 BuildQuality quality)
    : state_(std::make_unique<State>(geometry, scene, blendedAsMasked, quality)) {}

std::optional<TraceHit> ReferenceTracer::closestHit(const TraceRay& ray) const {
    RTCRayHit query;
    setRay(query.ray, ray);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    embree::Context context;
    embree::initContext(context);
    embree::intersect1(state_->handle.get(), context, query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return state_->hitOf(query.hit.geomID, query.hit.primID, query.ray.tfar, query.hit.u, query.hit.v);
}

bool ReferenceTracer::anyHit(const TraceRay& ray) const {
    RTCRay query;
    setRay(query, ray);
    embree::Context context;
    embree::initContext(context);
    embree::occluded1(state_->handle.get(), context, query);
    return query.tfar < 0; // Embree sets it to minus infinity
}

void ReferenceTracer::allHits(const TraceRay& ray, const std::function<bool(const TraceHit&)>& visit) const {
    RTCRayHit query;
    setRay(query.ray, ray);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    AllHitsContext context;
    embree::initContext(context.base);
    context.ray = shared::triangleRay(ray.origin, ray.direction);
    context.tMin = ray.tMin;
    context.tMax = ray.tMax;
    context.visit = &visit;
    context.stopped = false;
    embree::intersect1(state_->exact(), context.base, query);
}

void ReferenceTracer::closestHits(std::span<const TraceRay> rays, std::span<TraceHit> hits,
                                  bool coherent) const {
    KESTREL_CHECK_EQ(rays.size(), hits.size());
    alignas(64) RTCRayHit16 query;
    alignas(64) int valid[tracePacket];
    for (size_t first = 0; first < rays.size(); first += tracePacket) {
        fillPacket(query.ray, valid, rays, first);
        std::fill_n(query.hit.geomID, tracePacket, RTC_INVALID_GEOMETRY_ID);
        embree::Context context;
        embree::initContext(context);
        embree::intersect16(state_->handle.get(), context, valid, query, coherent);
        for (size_t i = 0; i < tracePacket && first + i < rays.size(); ++i) {
            hits[first + i] = state_->hitOf(query.hit.geomID[i], query.hit.primID[i], query.ray.tfar[i],
                                            query.hit.u[i], query.hit.v[i]);
        }
    }
}

void ReferenceTracer::anyHits(std::span<const TraceRay> rays, std::span<std::uint8_t> hits) const {
    KESTREL_CHECK_EQ(rays.size(), hits.size());
    alignas(64) RTCRay16 query;
    alignas(64) int valid[tracePacket];
    for (size_t first = 0; first < rays.size(); first += tracePacket) {
        fillPacket(query, valid, rays, first);
        embree::Context context;
        embree::initContext(context);
        embree::occluded16(state_->handle.get(), context, valid, query);
        for (size_t i = 0; i < tracePacket && first + i < rays.size(); ++i)
            hits[first + i] = query.tfar[i] < 0 ? 1 : 0;
    }
}

double ReferenceTracer::buildMs() const { return state_->buildMs; }

const Box& ReferenceTracer::bounds() const { return state_->bounds; }

#else

struct ReferenceTracer::State {};

ReferenceTracer::ReferenceTracer(const Geometry&, const Scene&, bool, BuildQuality) {
    throw MachineError("this build has no Embree, which the reference needs (libembree-dev)");
}

// No object of this class exists without Embree; what follows only satisfies the linker.
std::optional<TraceHit> ReferenceTracer::closestHit(const TraceRay&) const { return std::nullopt; }
bool ReferenceTracer::anyHit(const TraceRay&) const { return false; }
double ReferenceTracer::buildMs() const { return 0; }
void ReferenceTracer::allHits(const TraceRay&, const std::function<bool(const TraceHit&)>&) const {}
void ReferenceTracer::closestHits(std::span<const TraceRay>, std::span<TraceHit>, bool) const {}
void ReferenceTracer::anyHits(std::span<const TraceRay>, std::span<std::uint8_t>) const {}
double ReferenceTracer::buildMs() const { return state_->buildMs; }

const Box& ReferenceTracer::bounds() const {
    static const Box none;
    return none;
}

#endif

ReferenceTracer::~ReferenceTracer() = default;
ReferenceTracer::ReferenceTracer(ReferenceTracer&&) noexcept = default;
ReferenceTracer& ReferenceTracer::operator=(ReferenceTracer&&) noexcept = default;

} // namespace kestrel
