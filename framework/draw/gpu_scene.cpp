#include "draw/gpu_scene.h"
#include "core/check.h"
#include "core/error.h"
#include "draw/draw_calls.h"
#include "gl/loader.h"
#include "scene/least_alpha.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace kestrel {

using shared::LightRecord;
using shared::MaterialRecord;
using shared::TextureRecord;
using shared::VertexRecord;

// The std430 layouts of shared/scene.h.
static_assert(sizeof(TextureRecord) == 48 && offsetof(TextureRecord, source) == 32);
static_assert(sizeof(MaterialRecord) == 64 + 4 * 48 && offsetof(MaterialRecord, baseColourTexture) == 64);
static_assert(sizeof(VertexRecord) == 64 && sizeof(VertexRecord) == shared::vertexRecordTexels * 16);
static_assert(sizeof(LightRecord) == 96 && offsetof(LightRecord, halfSize) == 80);
static_assert(shared::lightKindSphere == static_cast<std::uint32_t>(LightKind::Sphere));

namespace {

// Where lib/vertex.glsl expects the vertex inputs.
namespace location {
constexpr unsigned int position = 0, normal = 1, tangent = 2, texCoord = 3, texCoord1 = 4, colour = 5,
                       previousPosition = 6;
} // namespace location

MaterialRecord recordOf(const Scene& scene, const Material& material, const SceneTextures& colours,
                        const SceneTextures& data) {
    MaterialRecord record{};
    record.baseColour = material.baseColour;
    record.emission = material.emission;
    record.metallic = material.metallic;
    record.roughness = material.roughness;
    record.normalScale = material.normalScale;
    record.transmission = material.transmission;
    record.ior = material.ior;
    const bool masked = material.alphaMode != AlphaMode::Opaque;
    record.alphaCutoff = masked ? leastAlpha(material) : 0;
    if (masked) record.flags |= shared::materialFlagMasked;
    if (material.alphaMode == AlphaMode::Blend) record.flags |= shared::materialFlagBlend;
    if (material.doubleSided) record.flags |= shared::materialFlagDoubleSided;
    if (material.unlit) record.flags |= shared::materialFlagUnlit;
    record.baseColourTexture = colours.record(scene, material.baseColourTexture);
    record.emissionTexture = colours.record(scene, material.emissionTexture);
    record.metallicRoughnessTexture = data.record(scene, material.metallicRoughnessTexture);
    record.normalTexture = data.record(scene, material.normalTexture);
    return record;
}

LightRecord recordOf(const LightState& light) {
    LightRecord record{};
    record.kind = static_cast<std::uint32_t>(light.kind);
    record.position = light.position;
    record.direction = light.direction;
    record.tangent = light.tangent;
    record.bitangent = light.bitangent;
    record.intensity = light.intensity;
    record.range = light.range;
    record.cosInnerCone = std::cos(light.innerCone);
    record.cosOuterCone = std::cos(light.outerCone);
    record.halfSize = light.halfSize;
    return record;
}

template<class T>
std::span<const std::byte> bytesOf(const std::vector<T>& items) {
    return std::as_bytes(std::span(items));
}

// Keeps the buffer where its size is right. True if it is a new one.
bool store(gl::Buffer& buffer, std::span<const std::byte> bytes, const char* label) {
    const bool fresh = !buffer || buffer.bytes() != bytes.size();
    if (fresh) buffer = gl::Buffer(bytes.size(), label);
    buffer.upload(bytes);
    return fresh;
}

// Of an array with one record an item: all of them into a new buffer where the size is another (true then),
// else those of `ranges` alone, since no other has changed.
template<class Record, class Item, class Make>
bool storeItems(gl::Buffer& buffer, const std::vector<Item>& items,
                const std::vector<Geometry::Range>& ranges, const char* label, const Make& make) {
    const bool fresh = !buffer || buffer.bytes() != items.size() * sizeof(Record);
    if (fresh) buffer = gl::Buffer(items.size() * sizeof(Record), label);
    std::vector<Record> records;
    const auto upload = [&](size_t first, size_t count) {
        records.resize(count);
        const auto from = items.begin() + static_cast<std::ptrdiff_t>(first);
        std::transform(from, from + static_cast<std::ptrdiff_t>(count), records.begin(), make);
        buffer.upload(bytesOf(records), first * sizeof(Record));
    };
    if (fresh) upload(0, items.size());
    if (!fresh)
        for (const Geometry::Range& range : ranges) upload(range.first, range.count);
    return fresh;
}

bool storePositions(gl::Buffer& buffer, const std::vector<glm::vec3>& positions,
                    const std::vector<Geometry::Range>& ranges, const char* label) {
    return storeItems<glm::vec4>(buffer, positions, ranges, label,
                                 [](const glm::vec3& position) { return glm::vec4(position, 1); });
}

bool storeVertices(gl::Buffer& buffer, const Geometry& geometry) {
    return storeItems<VertexRecord>(buffer, geometry.attributes, geometry.moving, "scene vertices",
                                    [](const VertexAttributes& vertex) {
                                        return VertexRecord{glm::vec4(vertex.normal, 0), vertex.tangent,
                                                            vertex.texCoord, vertex.texCoord1, vertex.colour};
                                    });
}

constexpr std::string_view colourTextures = "scene_colour_textures";
constexpr std::string_view dataTextures = "scene_data_textures";
constexpr std::string_view firstTriangle = "scene_first_triangle";
constexpr std::string_view firstMasked = "scene_first_masked", cutouts = "scene_cutouts",
                           cutoutAlpha = "scene_cutout_alpha";
constexpr std::string_view materialsBlock = "Materials";
constexpr std::string_view lightsBlock = "Lights";

void bindBlock(const gl::Program& program, std::string_view name, const gl::Buffer& buffer) {
    const auto slot = program.slot(name);
    if (!slot) return;
    // Beyond the limit a driver may bind a part in silence.
    GLint64 most = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    if (buffer.bytes() > static_cast<std::uint64_t>(most))
        throw MachineError(fmt::format("block '{}' of the scene has {} bytes, the device takes {}", name,
                                       buffer.bytes(), most));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, slot->unit, buffer.name());
}

void bindTexels(const gl::Program& program, std::string_view name, const gl::Buffer& buffer, Format format) {
    const auto slot = program.slot(name);
    if (!slot) return;
    const gl::Name view = buffer.texelView(format);
    if (slot->kind == gl::Program::Slot::Kind::Image) {
        glBindImageTexture(slot->unit, view, 0, GL_FALSE, 0, GL_READ_ONLY, gl::glFormat(format).internal);
    } else {
        glBindTextureUnit(slot->unit, view);
        glBindSampler(slot->unit, 0);
    }
}

} // namespace

GpuScene::GpuScene(const Scene& scene)
    : scene_(scene)
    , colours_(scene, TextureRole::Colour)
    , data_(scene, TextureRole::Data) {
    std::vector<MaterialRecord> records;
    for (const Material& material : flattenedMaterials(scene))
        records.push_back(recordOf(scene, material, colours_, data_));
    store(materials_, bytesOf(records), "scene materials");
    setLights({});
    update(Geometry{});
    hasTopology_ = false;
    geometry_ = nullptr;
}

void GpuScene::update(const Geometry& geometry) {
    KESTREL_CHECK_EQ(geometry.positions.size(), geometry.attributes.size());
    geometry_ = &geometry;
    bool fresh = storePositions(positions_, geometry.positions, geometry.moving, "scene positions");
    fresh |= storeVertices(vertices_, geometry);
    const bool moves = !geometry.previousPositions.empty();
    if (moves) {
        KESTREL_CHECK_EQ(geometry.previousPositions.size(), geometry.positions.size());
        fresh |= storePositions(previousPositions_, geometry.previousPositions, geometry.moving,
                                "scene previous positions");
    }
    fresh |= moves != moves_;
    moves_ = moves;
    if (!hasTopology_ || turns_ != geometry.turns || fresh) fresh |= uploadTopology(geometry);
    if (fresh) linkVertexArray();
}

bool GpuScene::uploadTopology(const Geometry& geometry) {
    triangleCount_ = geometry.triangleCount();
    KESTREL_CHECK_EQ(geometry.materials.size(), size_t{triangleCount_});
    std::vector<glm::uvec4> triangles(triangleCount_);
    for (size_t i = 0; i < triangles.size(); ++i)
        triangles[i] = {geometry.indices[3 * i], geometry.indices[3 * i + 1], geometry.indices[3 * i + 2],
                        geometry.materials[i]};
    const bool fresh = store(indices_, bytesOf(geometry.indices), "scene indices");
    store(triangles_, bytesOf(triangles), "scene triangles");
    if (cutouts_) cutouts_->setTriangles(geometry);
    std::copy(std::begin(geometry.ranges), std::end(geometry.ranges), std::begin(ranges_));
    hasTopology_ = true;
    turns_ = geometry.turns;
    return fresh;
}

void GpuScene::linkVertexArray() {
    vertexArray_ = gl::VertexArray("scene");
    noVertices_ = gl::VertexArray("scene by number");
    vertexArray_.setIndices(indices_);
    constexpr std::uint32_t texel = 16;
    vertexArray_.setAttribute(location::position, positions_, 3, texel, 0);
    vertexArray_.setAttribute(location::previousPosition, moves_ ? previousPositions_ : positions_, 3, texel,
                              0);
    const auto attribute = [this](unsigned int at, int components, size_t offset) {
        vertexArray_.setAttribute(at, vertices_, components, sizeof(VertexRecord),
                                  static_cast<std::uint32_t>(offset));
    };
    attribute(location::normal, 3, offsetof(VertexRecord, normal));
    attribute(location::tangent, 4, offsetof(VertexRecord, tangent));
    attribute(location::texCoord, 2, offsetof(VertexRecord, texCoord));
    attribute(location::texCoord1, 2, offsetof(VertexRecord, texCoord1));
    attribute(location::colour, 4, offsetof(VertexRecord, colour));
}

void GpuScene::setLights(const std::vector<LightState>& lights) {
    if (lights_ && lights == uploadedLights_) return;
    // The block: the count, filled up to 16 bytes, then the records.
    std::vector<std::byte> bytes(16 + lights.size() * sizeof(LightRecord));
    const auto count = static_cast<std::uint32_t>(lights.size());
    std::memcpy(bytes.data(), &count, sizeof count);
    for (size_t i = 0; i < lights.size(); ++i) {
        const LightRecord record = recordOf(lights[i]);
        std::memcpy(bytes.data() + 16 + i * sizeof record, &record, sizeof record);
    }
    store(lights_, bytes, "scene lights");
    uploadedLights_ = lights;
}

std::vector<GpuScene::TexelSource> GpuScene::texelSources() const {
    return {{"scene_positions", "ScenePositions", positions_, Format::RGBA32F},
            {"scene_previous_positions", "ScenePreviousPositions", moves_ ? previousPositions_ : positions_,
             Format::RGBA32F},
            {"scene_vertices", "SceneVertices", vertices_, Format::RGBA32F},
            {"scene_triangles", "SceneTriangles", triangles_, Format::RGBA32UI}};
}

bool GpuScene::reserves(std::string_view name) {
    constexpr std::string_view names[] = {"scene_positions", "scene_previous_positions",
                                          "scene_vertices",  "scene_triangles",
                                          "ScenePositions",  "ScenePreviousPositions",
                                          "SceneVertices",   "SceneTriangles",
                                          cutouts,           cutoutAlpha,
                                          firstMasked,       colourTextures,
                                          dataTextures,      firstTriangle,
                                          materialsBlock,    lightsBlock};
    return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

void GpuScene::bindCutouts(const gl::Program& program) {
    const int first = program.uniform(firstMasked);
    if (first < 0 && !program.slot(cutouts) && !program.slot(cutoutAlpha)) return;
    if (!cutouts_) {
        cutouts_.emplace(scene_, colours_);
        if (geometry_ != nullptr) cutouts_->setTriangles(*geometry_);
    }
    bindTexels(program, cutouts, cutouts_->records(), Format::RGBA32UI);
    bindTexels(program, cutoutAlpha, cutouts_->alpha(), Format::R32UI);
    if (first >= 0) glProgramUniform1ui(program.name(), first, cutouts_->first());
}

void GpuScene::bind(const gl::Program& program) {
    bindBlock(program, materialsBlock, materials_);
    bindBlock(program, lightsBlock, lights_);
    for (const TexelSource& source : texelSources()) {
        bindBlock(program, source.block, source.buffer);
        bindTexels(program, source.uniform, source.buffer, source.format);
    }
    bindCutouts(program);
    if (const auto slot = program.slot(colourTextures)) colours_.bind(*slot);
    if (const auto slot = program.slot(dataTextures)) data_.bind(*slot);
}

void GpuScene::draw(const DrawState& state, const std::vector<TriangleClass>& classes,
                    const gl::Program& program) const {
    applyDrawState(state);
    glBindVertexArray(state.byNumber ? noVertices_.name() : vertexArray_.name());
    const int first = program.uniform(firstTriangle);
    for (const TriangleClass drawn : classes) {
        KESTREL_CHECK(drawn < TriangleClass::Count);
        const Geometry::Range range = ranges_[static_cast<size_t>(drawn)];
        if (range.count == 0) continue;
        const bool doubleSided =
            drawn == TriangleClass::OpaqueDoubleSided || drawn == TriangleClass::MaskedDoubleSided;
        setCulling(doubleSided ? Cull::None : state.cull);
        if (first >= 0) glProgramUniform1ui(program.name(), first, range.first);
        if (state.byNumber) {
            glDrawArraysInstanced(GL_TRIANGLES, static_cast<GLint>(3 * range.first),
                                  static_cast<GLsizei>(3 * range.count),
                                  static_cast<GLsizei>(state.instances));
            continue;
        }
        const auto* offset = reinterpret_cast<const void*>(size_t{range.first} * 3 * sizeof(std::uint32_t));
        glDrawElementsInstanced(GL_TRIANGLES, static_cast<GLsizei>(3 * range.count), GL_UNSIGNED_INT, offset,
                                static_cast<GLsizei>(state.instances));
    }
}

std::uint64_t GpuScene::bytes() const {
    std::uint64_t total = colours_.bytes() + data_.bytes() + (cutouts_ ? cutouts_->bytes() : 0);
    for (const gl::Buffer* buffer :
         {&materials_, &lights_, &positions_, &previousPositions_, &vertices_, &indices_, &triangles_})
        total += buffer->bytes();
    return total;
}

} // namespace kestrel
