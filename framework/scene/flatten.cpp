#include "core/error.h"
#include "scene/deform.h"
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <thread>

namespace kestrel {
namespace {

constexpr size_t classCount = static_cast<size_t>(TriangleClass::Count);
// Vertices that one thread takes at a time; a multiple of 3, so that triangles with flat normals stay whole.
constexpr size_t chunkVertices = size_t{3} * 8192;

TriangleClass classOf(const Material& material) {
    if (material.alphaMode == AlphaMode::Opaque)
        return material.doubleSided ? TriangleClass::OpaqueDoubleSided : TriangleClass::Opaque;
    return material.doubleSided ? TriangleClass::MaskedDoubleSided : TriangleClass::Masked;
}

// Where an instance stands in the flattened arrays, and what was last written there.
struct Placed {
    Instance instance;
    InstanceMotion motion;
    std::uint32_t material = 0;
    TriangleClass triangleClass = TriangleClass::Opaque;
    size_t firstVertex = 0, firstTriangle = 0;
    bool mirrored = false; // the winding that the indices have now
    Box bounds;            // at the time last written
};

struct Chunk {
    size_t placed = 0, first = 0, end = 0; // vertices of the instance
    Box bounds;
};

// Calls work(chunk) for all chunks, on two threads where that pays.
template<class Work>
void forEachChunk(std::vector<Chunk>& chunks, const Work& work) {
    std::atomic<size_t> next{0};
    const auto drain = [&] {
        for (size_t i = next++; i < chunks.size(); i = next++) work(chunks[i]);
    };
    if (chunks.size() < 2 || std::thread::hardware_concurrency() < 2) return drain();
    std::jthread helper(drain);
    drain();
}

// The normal of three corners (twice the area long), in double precision so that no small triangle loses it.
glm::dvec3 crossOf(const glm::vec3* corner) {
    const glm::dvec3 a(corner[0]);
    return glm::cross(glm::dvec3(corner[1]) - a, glm::dvec3(corner[2]) - a);
}

} // namespace

struct Flattener::State {
    const Scene& scene;
    std::vector<Placed> placed;
    std::vector<Chunk> moving; // the chunks of what moves
    Geometry geometry;
    double time = 0, previousTime = 0;
    bool fresh = true; // nothing was written yet

    explicit State(const Scene& theScene)
        : scene(theScene) {
        place();
        layOut();
        findMoving();
    }

    void place() {
        const std::vector<Instance> instances = instancesOf(scene);
        const std::vector<InstanceMotion> motion = instanceMotion(scene, instances);
        const std::vector<Material> materials = flattenedMaterials(scene);
        std::array<size_t, classCount> triangles{};
        size_t vertices = 0;
        placed.reserve(instances.size());
        for (size_t i = 0; i < instances.size(); ++i) {
            const Primitive& primitive = *instances[i].primitive;
            Placed one;
            one.instance = instances[i];
            one.motion = motion[i];
            one.material = static_cast<std::uint32_t>(
                primitive.material < 0 ? materials.size() - 1 : static_cast<size_t>(primitive.material));
            one.triangleClass = classOf(materials[one.material]);
            one.firstVertex = vertices;
            geometry.instances.push_back({static_cast<std::uint32_t>(vertices),
                                          static_cast<std::uint32_t>(primitive.positions.size())});
            one.firstTriangle = triangles[static_cast<size_t>(one.triangleClass)];
            vertices += primitive.positions.size();
            triangles[static_cast<size_t>(one.triangleClass)] += primitive.indices.size() / 3;
            placed.push_back(one);
        }
        size_t first = 0;
        for (size_t c = 0; c < classCount; ++c) {
            geometry.ranges[c] = {static_cast<std::uint32_t>(first),
                                  static_cast<std::uint32_t>(triangles[c])};
            first += triangles[c];
        }
        if (first > maxTriangles || vertices > maxVertices)
            throw InputError(Location{scene.source},
                             fmt::format("the scene has {} triangles and {} vertices with all its instances; "
                                         "at most {} and {} are flattened",
                                         first, vertices, maxTriangles, maxVertices));
        for (Placed& one : placed)
            one.firstTriangle += geometry.ranges[static_cast<size_t>(one.triangleClass)].first;
        geometry.positions.resize(vertices);
        geometry.attributes.resize(vertices);
        geometry.indices.resize(3 * first);
        geometry.materials.resize(first);
    }

    void layOut() {
        for (const Placed& one : placed) {
            writeIndices(one);
            const Primitive& primitive = *one.instance.primitive;
            std::fill_n(geometry.materials.begin() + static_cast<std::ptrdiff_t>(one.firstTriangle),
                        primitive.indices.size() / 3, one.material);
            VertexAttributes* attributes = geometry.attributes.data() + one.firstVertex;
            for (size_t i = 0; i < primitive.positions.size(); ++i) {
                if (!primitive.texCoords.empty()) attributes[i].texCoord = primitive.texCoords[i];
                if (!primitive.texCoords1.empty()) attributes[i].texCoord1 = primitive.texCoords1[i];
                if (!primitive.colours.empty()) attributes[i].colour = primitive.colours[i];
            }
        }
    }

    // Neighbours that move are one range.
    void findMoving() {
        for (const Placed& one : placed) {
            const auto count = static_cast<std::uint32_t>(one.instance.primitive->positions.size());
            if (!one.motion.moves || count == 0) continue;
            const auto first = static_cast<std::uint32_t>(one.firstVertex);
            std::vector<Geometry::Range>& ranges = geometry.moving;
            if (!ranges.empty() && ranges.back().first + ranges.back().count == first)
                ranges.back().count += count;
            else
                ranges.push_back({first, count});
        }
    }

    void writeIndices(const Placed& one) {
        const std::vector<std::uint32_t>& source = one.instance.primitive->indices;
        std::uint32_t* indices = geometry.indices.data() + 3 * one.firstTriangle;
        const std::uint32_t first = static_cast<std::uint32_t>(one.firstVertex);
        for (size_t i = 0; i + 2 < source.size(); i += 3) {
            indices[i] = first + source[i];
            indices[i + 1] = first + source[i + (one.mirrored ? 2 : 1)];
            indices[i + 2] = first + source[i + (one.mirrored ? 1 : 2)];
        }
    }

    std::vector<Chunk> chunksOf(bool all) const {
        std::vector<Chunk> chunks;
        for (size_t i = 0; i < placed.size(); ++i) {
            const size_t count = placed[i].instance.primitive->positions.size();
            if (!all && !placed[i].motion.moves) continue;
            for (size_t first = 0; first < count; first += chunkVertices)
                chunks.push_back({i, first, std::min(first + chunkVertices, count), {}});
        }
        return chunks;
    }

    std::vector<Deformation> deformations(const Pose& pose) const {
        std::vector<Deformation> result;
        result.reserve(placed.size());
        for (const Placed& one : placed) result.emplace_back(scene, pose, one.instance);
        return result;
    }

    void writePositions(const std::vector<Deformation>& deformations, Chunk& chunk,
                        std::vector<glm::vec3>& positions) const {
        glm::vec3* out = positions.data() + placed[chunk.placed].firstVertex;
        const Deformation& deformation = deformations[chunk.placed];
        chunk.bounds = {};
        for (size_t i = chunk.first; i < chunk.end; ++i) {
            out[i] = glm::vec3(deformation.position(i) - scene.origin);
            chunk.bounds.add(out[i]);
        }
    }

    void writeAttributes(const Deformation& deformation, const Chunk& chunk) {
        const Placed& one = placed[chunk.placed];
        VertexAttributes* out = geometry.attributes.data() + one.firstVertex;
        for (size_t i = chunk.first; i < chunk.end; ++i) deformation.normalAndTangent(i, out[i]);
        if (!one.instance.primitive->flatNormals) return;
        const glm::vec3* positions = geometry.positions.data() + one.firstVertex;
        for (size_t i = chunk.first; i + 2 < chunk.end; i += 3) {
            const glm::dvec3 cross = crossOf(positions + i);
            const double length = std::sqrt(glm::dot(cross, cross)) * (deformation.mirrors() ? -1 : 1);
            if (length == 0) continue; // a degenerate triangle keeps its normal of the mesh
            for (size_t k = 0; k < 3; ++k) out[i + k].normal = glm::vec3(cross / length);
        }
    }

    // Writes the chunks as they are at `newTime`.
    void write(std::vector<Chunk>& chunks, double newTime) {
        const Pose pose = poseAt(scene, newTime);
        const std::vector<Deformation> deformed = deformations(pose);
        forEachChunk(chunks, [&](Chunk& chunk) {
            writePositions(deformed, chunk, geometry.positions);
            writeAttributes(deformed[chunk.placed], chunk);
        });
        for (const Chunk& chunk : chunks) placed[chunk.placed].bounds = {};
        for (const Chunk& chunk : chunks) placed[chunk.placed].bounds.add(chunk.bounds);
        geometry.bounds = {};
        bool turned = false;
        for (size_t i = 0; i < placed.size(); ++i) {
            geometry.bounds.add(placed[i].bounds);
            if (placed[i].mirrored == deformed[i].mirrors()) continue;
            placed[i].mirrored = deformed[i].mirrors();
            writeIndices(placed[i]);
            turned = true;
        }
        if (turned) ++geometry.turns;
        time = newTime;
    }

    void update(double newTime) {
        if (fresh) {
            std::vector<Chunk> all = chunksOf(true);
            write(all, newTime);
            moving = chunksOf(false);
            fresh = false;
        } else if (newTime != time && !moving.empty()) {
            write(moving, newTime);
        }
    }

    void updatePrevious(double newPreviousTime) {
        if (moving.empty()) return geometry.previousPositions.clear();
        if (geometry.previousPositions.empty()) {
            geometry.previousPositions = geometry.positions;
            previousTime = time;
        }
        if (previousTime == newPreviousTime) return;
        const Pose pose = poseAt(scene, newPreviousTime);
        const std::vector<Deformation> deformed = deformations(pose);
        forEachChunk(moving,
                     [&](Chunk& chunk) { writePositions(deformed, chunk, geometry.previousPositions); });
        previousTime = newPreviousTime;
    }
};

Flattener::Flattener(const Scene& scene)
    : state_(std::make_unique<State>(scene)) {}
Flattener::Flattener(Flattener&&) noexcept = default;
Flattener& Flattener::operator=(Flattener&&) noexcept = default;
Flattener::~Flattener() = default;

const Geometry& Flattener::at(double time) {
    state_->update(time);
    state_->geometry.previousPositions.clear();
    return state_->geometry;
}

const Geometry& Flattener::at(double time, double previousTime) {
    State& state = *state_;
    // Frame after frame, the last frame's positions are at hand: what stands still is equal in both arrays.
    if (!state.fresh && previousTime == state.time && time != previousTime && !state.moving.empty()) {
        if (state.geometry.previousPositions.empty())
            state.geometry.previousPositions = state.geometry.positions;
        else
            std::swap(state.geometry.positions, state.geometry.previousPositions);
        state.previousTime = previousTime;
    }
    state.update(time);
    state.updatePrevious(previousTime);
    return state.geometry;
}

std::vector<Material> flattenedMaterials(const Scene& scene) {
    std::vector<Material> materials = scene.materials;
    materials.emplace_back();
    return materials;
}

Geometry Flattener::take() && { return std::move(state_->geometry); }

Geometry flatten(const Scene& scene, double time) {
    Flattener flattener(scene);
    flattener.at(time);
    return std::move(flattener).take();
}

Geometry flatten(const Scene& scene, double time, double previousTime) {
    Flattener flattener(scene);
    flattener.at(time, previousTime);
    return std::move(flattener).take();
}

} // namespace kestrel
