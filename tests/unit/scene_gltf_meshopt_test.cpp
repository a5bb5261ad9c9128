// Buffer views that EXT_meshopt_compression and KHR_meshopt_compression compress.
#include "scene/gltf_import.h"
#include "scene/gltf_views.h"
#include "scene/meshopt_attributes.h"
#include "support/grid_file.h"
#include "support/meshopt_encoder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>
#ifdef KESTREL_HAS_MESHOPT
#include <meshoptimizer.h>
#endif

namespace kestrel::gltf_meshopt_test {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::Grid;
using test::importMessage;
using test::MeshoptEncoder;
using test::TemporaryFolder;
using testing::HasSubstr;

// ---- streams of version 1

std::vector<std::uint8_t> randomElements(size_t count, size_t stride, unsigned int seed) {
    std::mt19937 random(seed);
    std::vector<std::uint8_t> elements(count * stride);
    for (size_t i = 0; i < count; ++i)
        for (size_t k = 0; k < stride; ++k) {
            // Bytes that stand still, creep and jump.
            const std::uint8_t last = i == 0 ? std::uint8_t{7} : elements[(i - 1) * stride + k];
            const unsigned int step = k % 4 == 0   ? random() % 256
                                      : k % 4 == 1 ? random() % 4
                                      : k % 4 == 2 ? random() % 12
                                                   : 0;
            elements[i * stride + k] = static_cast<std::uint8_t>(last + step);
        }
    return elements;
}

std::span<const std::byte> bytesOf(const std::vector<std::uint8_t>& values) {
    return std::as_bytes(std::span(values));
}

TEST(MeshoptAttributes, GiveBackWhatWasEncodedInEveryWay) {
    for (const size_t stride : {4, 8, 12, 16, 64, 256})
        for (const size_t count : {1, 15, 16, 17, 255, 256, 257, 700})
            for (const std::uint8_t channel : {0x00, 0x01, 0x02, 0x72, 0xF2}) {
                SCOPED_TRACE(testing::Message() << stride << " x " << count << ", channel " << int(channel));
                const std::vector<std::uint8_t> elements = randomElements(count, stride, 3);
                const std::vector<std::uint8_t> stream =
                    MeshoptEncoder::encode(elements, stride, std::vector<std::uint8_t>(stride / 4, channel));
                std::vector<std::uint8_t> decoded(elements.size());
                ASSERT_TRUE(decodeMeshoptAttributes1(bytesOf(stream), count, stride,
                                                     reinterpret_cast<std::byte*>(decoded.data())));
                ASSERT_EQ(decoded, elements);
            }
}

TEST(MeshoptAttributes, TheSpecifiedExampleOfFourBitDeltas) {
    // Appendix A: 16 zigzag deltas of 4 bits, two of them whole bytes; as one group of control mode 1.
    const std::vector<int> deltas = {-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0};
    std::vector<std::uint8_t> stream = {0xA1, 0b10101001, 0b10, 0x17, 0x5f, 0xf0, 0xbc,
                                        0x77, 0xa9,       0x21, 0x00, 0x34, 0xb5};
    stream.resize(stream.size() + 24, 0);
    std::vector<std::uint8_t> decoded(16 * 4);
    ASSERT_TRUE(
        decodeMeshoptAttributes1(bytesOf(stream), 16, 4, reinterpret_cast<std::byte*>(decoded.data())));
    int value = 0;
    for (size_t i = 0; i < 16; ++i) {
        value += deltas[i];
        EXPECT_EQ(decoded[4 * i], static_cast<std::uint8_t>(value)) << i;
        EXPECT_EQ(decoded[4 * i + 1], 0);
    }
}

TEST(MeshoptAttributes, EveryTruncationAndAnyMutationIsSurvived) {
    const std::vector<std::uint8_t> elements = randomElements(300, 12, 5);
    const std::vector<std::uint8_t> stream = MeshoptEncoder::encode(elements, 12, {0, 1, 0x32});
    for (size_t size = 0; size < stream.size(); ++size) {
        // Of just that size, so that an overrun is seen.
        const std::vector<std::uint8_t> cut(stream.begin(),
                                            stream.begin() + static_cast<std::ptrdiff_t>(size));
        std::vector<std::byte> decoded(elements.size());
        EXPECT_FALSE(decodeMeshoptAttributes1(bytesOf(cut), 300, 12, decoded.data())) << size;
    }
    std::mt19937 random(1);
    for (int round = 0; round < 5000; ++round) {
        std::vector<std::uint8_t> bent = stream;
        for (int i = 0; i < 3; ++i) bent[random() % bent.size()] = static_cast<std::uint8_t>(random());
        std::vector<std::byte> decoded(elements.size());
        static_cast<void>(decodeMeshoptAttributes1(bytesOf(bent), 300, 12, decoded.data()));
    }
}

TEST(MeshoptColours, AreRedGreenBlueAndAlphaAgain) {
    // Grey 100, and red 200, green 100, blue 50 with half alpha: r = y + co - cg, g = y + cg, b = y - co -
    // cg.
    const int y = 113, co = 75, cg = -13; // of 200, 100, 51
    std::vector<std::uint8_t> elements = {100, 0, 0, 0xFF, y, co, static_cast<std::uint8_t>(cg), 0x80 | 64};
    decodeMeshoptColours(reinterpret_cast<std::byte*>(elements.data()), 2, 4);
    EXPECT_THAT(elements, testing::ElementsAre(100, 100, 100, 255, 201, 100, 51, 128));
    // Six bits in 16-bit components: 63 is one.
    std::vector<std::uint16_t> wide = {63, 0, 0, 0x3F, 32, 0, 0, 0x20};
    decodeMeshoptColours(reinterpret_cast<std::byte*>(wide.data()), 2, 8);
    EXPECT_THAT(wide, testing::ElementsAre(65535, 65535, 65535, 65535, 33288, 33288, 33288, 0));
}

#ifdef KESTREL_HAS_MESHOPT

// ---- files

struct Coded {
    std::vector<std::uint8_t> stream;
    size_t count = 0, stride = 0;
    const char* mode = "ATTRIBUTES";
    const char* filter = "NONE";
};

template<class T>
Coded attributes(const std::vector<T>& values, size_t components, const char* filter = "NONE") {
    Coded coded{{}, values.size() / components, components * sizeof(T)};
    coded.filter = filter;
    coded.stream.resize(meshopt_encodeVertexBufferBound(coded.count, coded.stride));
    coded.stream.resize(meshopt_encodeVertexBuffer(coded.stream.data(), coded.stream.size(), values.data(),
                                                   coded.count, coded.stride));
    return coded;
}

Coded triangles(const std::vector<std::uint16_t>& indices, size_t vertices, bool sequence = false) {
    const std::vector<unsigned int> wide(indices.begin(), indices.end());
    Coded coded{{}, wide.size(), 2, sequence ? "INDICES" : "TRIANGLES"};
    coded.stream.resize(meshopt_encodeIndexBufferBound(wide.size(), vertices) +
                        meshopt_encodeIndexSequenceBound(wide.size(), vertices));
    coded.stream.resize(
        sequence
            ? meshopt_encodeIndexSequence(coded.stream.data(), coded.stream.size(), wide.data(), wide.size())
            : meshopt_encodeIndexBuffer(coded.stream.data(), coded.stream.size(), wide.data(), wide.size()));
    return coded;
}

// A view of what is decompressed, in a buffer of its own that has no data.
size_t addView(GltfBuilder& builder, const Coded& coded, const char* extension) {
    const size_t source = builder.view(coded.stream);
    json& views = builder.document["bufferViews"];
    const json compressed = views[source];
    views[source] = {{"buffer", 1},
                     {"byteLength", coded.count * coded.stride},
                     {"extensions",
                      {{extension,
                        {{"buffer", 0},
                         {"byteOffset", compressed["byteOffset"]},
                         {"byteLength", coded.stream.size()},
                         {"byteStride", coded.stride},
                         {"count", coded.count},
                         {"mode", coded.mode},
                         {"filter", coded.filter}}}}}};
    if (std::string_view(coded.mode) == "ATTRIBUTES") views[source]["byteStride"] = coded.stride;
    return source;
}

size_t addAccessor(GltfBuilder& builder, size_t view, size_t count, const char* type, int componentType,
                   bool normalized = false) {
    builder.document["accessors"].push_back({{"bufferView", view},
                                             {"componentType", componentType},
                                             {"count", count},
                                             {"type", type},
                                             {"normalized", normalized}});
    return builder.document["accessors"].size() - 1;
}

void finish(GltfBuilder& builder, const char* extension) {
    builder.document["extensionsUsed"] = builder.document["extensionsRequired"] = {extension};
    builder.document["buffers"] = {
        {{"byteLength", builder.data.size()},
         {"uri", "data:application/octet-stream;base64," + test::base64(builder.data)}},
        {{"byteLength", 1 << 20}, {"extensions", {{extension, {{"fallback", true}}}}}}};
}

GltfBuilder compressed(const Grid& grid, const char* extension, bool sequence) {
    GltfBuilder builder;
    const auto floats = [&](const std::vector<float>& values, size_t components, const char* type) {
        return addAccessor(builder, addView(builder, attributes(values, components), extension),
                           values.size() / components, type, test::Float);
    };
    const size_t p = floats(grid.positions, 3, "VEC3"), n = floats(grid.normals, 3, "VEC3"),
                 t = floats(grid.texCoords, 2, "VEC2");
    const size_t i =
        addAccessor(builder, addView(builder, triangles(grid.indices, grid.vertices(), sequence), extension),
                    grid.indices.size(), "SCALAR", test::UnsignedShort);
    builder.addMeshNode(
        {{"attributes", {{"POSITION", p}, {"NORMAL", n}, {"TEXCOORD_0", t}}}, {"indices", i}});
    finish(builder, extension);
    return builder;
}

TEST(GltfMeshopt, GivesTheSameTrianglesAsThePlainFile) {
    const TemporaryFolder folder;
    const Grid grid(20);
    const Scene plain = grid.file().import(folder);
    for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
        // A list of triangles may be stored from another corner on; a sequence is as it was.
        const Scene sequence = compressed(grid, extension, true).import(folder);
        EXPECT_EQ(sequence.meshes, plain.meshes);
        EXPECT_TRUE(sequence.warnings.empty());
        const Primitive turned = compressed(grid, extension, false).import(folder).meshes[0].primitives[0];
        const Primitive& wanted = plain.meshes[0].primitives[0];
        EXPECT_EQ(turned.positions, wanted.positions);
        ASSERT_EQ(turned.indices.size(), wanted.indices.size());
        for (size_t i = 0; i < wanted.indices.size(); i += 3) {
            std::array<std::uint32_t, 3> corners{turned.indices[i], turned.indices[i + 1],
                                                 turned.indices[i + 2]};
            for (int turn = 0; turn < 2 && corners[0] != wanted.indices[i]; ++turn)
                std::rotate(corners.begin(), corners.begin() + 1, corners.end());
            EXPECT_THAT(corners, testing::ElementsAre(wanted.indices[i], wanted.indices[i + 1],
                                                      wanted.indices[i + 2]));
        }
    }
}

TEST(GltfMeshopt, VersionOneIsRead) {
    const TemporaryFolder folder;
    const Grid grid(20);
    GltfBuilder builder;
    Coded coded{{}, grid.vertices(), 12};
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(grid.positions.data());
    coded.stream = MeshoptEncoder::encode({bytes, 4 * grid.positions.size()}, 12, {0, 1, 0x82});
    const size_t p = addAccessor(builder, addView(builder, coded, "KHR_meshopt_compression"), coded.count,
                                 "VEC3", test::Float);
    const size_t i = builder.accessor(grid.indices, 1, test::UnsignedShort);
    builder.addMeshNode({{"attributes", {{"POSITION", p}}}, {"indices", i}});
    finish(builder, "KHR_meshopt_compression");
    EXPECT_EQ(builder.import(folder).meshes[0].primitives[0].positions,
              grid.file().import(folder).meshes[0].primitives[0].positions);
}

TEST(GltfMeshopt, FiltersGiveWhatTheyStandForWithinTheirBits) {
    const TemporaryFolder folder;
    const Grid grid(9);
    std::vector<float> four;
    for (size_t i = 0; i < grid.vertices(); ++i)
        four.insert(four.end(), {grid.normals[3 * i], grid.normals[3 * i + 1], grid.normals[3 * i + 2], 0});
    std::vector<std::int16_t> octahedral(four.size());
    meshopt_encodeFilterOct(octahedral.data(), grid.vertices(), 8, 12, four.data());
    std::vector<std::uint32_t> exponential(grid.positions.size());
#if MESHOPTIMIZER_VERSION > 180 // which shared the exponents of a vector without being told
    meshopt_encodeFilterExp(exponential.data(), grid.vertices(), 12, 15, grid.positions.data(),
                            meshopt_EncodeExpSharedVector);
#else
    meshopt_encodeFilterExp(exponential.data(), grid.vertices(), 12, 15, grid.positions.data());
#endif
    GltfBuilder builder;
    const char* extension = "EXT_meshopt_compression";
    const size_t p =
        addAccessor(builder, addView(builder, attributes(exponential, 3, "EXPONENTIAL"), extension),
                    grid.vertices(), "VEC3", test::Float);
    const size_t n =
        addAccessor(builder, addView(builder, attributes(octahedral, 4, "OCTAHEDRAL"), extension),
                    grid.vertices(), "VEC3", test::Short, true);
    const size_t i = builder.accessor(grid.indices, 1, test::UnsignedShort);
    builder.addMeshNode({{"attributes", {{"POSITION", p}, {"NORMAL", n}}}, {"indices", i}});
    finish(builder, extension);
    builder.document["extensionsRequired"].push_back("KHR_mesh_quantization");
    const Primitive filtered = builder.import(folder).meshes[0].primitives[0];
    const Primitive plain = grid.file().import(folder).meshes[0].primitives[0];
    ASSERT_EQ(filtered.positions.size(), plain.positions.size());
    for (size_t v = 0; v < plain.positions.size(); ++v) {
        // 15 bits of a value up to 1, 12 bits of a direction: half a step, and twice that for the
        // octahedron's slope.
        EXPECT_LT(glm::length(filtered.positions[v] - plain.positions[v]), 1e-4f);
        EXPECT_LT(glm::length(filtered.normals[v] - plain.normals[v]), 1e-3f);
    }
}

TEST(GltfMeshopt, SaysWhatIsWrong) {
    const Grid grid(4);
    const GltfBuilder good = compressed(grid, "EXT_meshopt_compression", false);
    ASSERT_EQ(importMessage(good), "no error");
    const auto spoilt = [&](const char* member, const json& value, size_t view = 0) {
        GltfBuilder bad = good;
        bad.document["bufferViews"][view]["extensions"]["EXT_meshopt_compression"][member] = value;
        return importMessage(bad);
    };
    EXPECT_THAT(spoilt("mode", "POINTS"),
                HasSubstr("bufferViews[0] is compressed in the mode 'POINTS', which Kestrel "
                          "does not know"));
    EXPECT_THAT(spoilt("filter", "FOURIER"),
                HasSubstr("bufferViews[0] has the compression filter 'FOURIER'"));
    EXPECT_THAT(spoilt("filter", "OCTAHEDRAL"), HasSubstr("which elements of 12 bytes do not fit"));
    EXPECT_THAT(spoilt("byteStride", 6), HasSubstr("do not fit"));
    EXPECT_THAT(spoilt("count", 24),
                HasSubstr("bufferViews[0] has 300 bytes, but 24 compressed elements of 12"));
    EXPECT_THAT(spoilt("byteLength", 1 << 20), HasSubstr("of buffers[0], which has"));
    EXPECT_THAT(spoilt("buffer", 7), HasSubstr("buffer is 7, but there are 2 buffers"));
    EXPECT_THAT(spoilt("mode", "TRIANGLES"), HasSubstr("bufferViews[0] has 25 indices of triangles"));
}

TEST(GltfMeshopt, EveryTruncationAndAnyMutationIsAnErrorOrAScene) {
    const Grid grid(4);
    const GltfBuilder good = compressed(grid, "EXT_meshopt_compression", false);
    for (size_t view = 0; view < 4; ++view) {
        const size_t whole =
            good.document["bufferViews"][view]["extensions"]["EXT_meshopt_compression"]["byteLength"]
                .get<size_t>();
        for (size_t size = 1; size < whole; size += 3) {
            GltfBuilder cut = good;
            cut.document["bufferViews"][view]["extensions"]["EXT_meshopt_compression"]["byteLength"] = size;
            EXPECT_THAT(importMessage(cut), HasSubstr("has a broken compressed stream"))
                << view << ": " << size;
        }
    }
    std::mt19937 random(1);
    for (int round = 0; round < 200; ++round) {
        GltfBuilder bent = good;
        for (int i = 0; i < 3; ++i)
            bent.data[random() % bent.data.size()] = static_cast<unsigned char>(random());
        finish(bent, "EXT_meshopt_compression");
        EXPECT_EQ(importMessage(bent).find('\n'), std::string::npos);
    }
}

TEST(GltfMeshopt, DecompressionIsBounded) {
    const Grid grid(4);
    const GltfBuilder good = compressed(grid, "EXT_meshopt_compression", false);
    EXPECT_THAT(
        importMessage(good, {.decodedBytes = 299}),
        HasSubstr(
            "bufferViews[0] decompresses to 25 elements of 12 bytes; at most 299 bytes are decompressed "
            "for one file"));
    GltfBuilder giant = good;
    json& view = giant.document["bufferViews"][0];
    view["byteLength"] = std::uint64_t{12} * 900'000'000;
    view["extensions"]["EXT_meshopt_compression"]["count"] = 900'000'000;
    EXPECT_THAT(importMessage(giant), HasSubstr("at most 2147483648 bytes are decompressed for one file"));
}

TEST(GltfMeshopt, ThePlainFallbackIsNotNeeded) {
    const TemporaryFolder folder;
    const Grid grid(4);
    GltfBuilder builder = compressed(grid, "EXT_meshopt_compression", true);
    builder.document["buffers"][1]["uri"] = "not-there.bin";
    builder.document.erase("extensionsRequired");
    EXPECT_EQ(builder.import(folder).meshes, grid.file().import(folder).meshes);
}

#else

TEST(GltfMeshopt, IsRefusedByNameWithoutThePackage) { EXPECT_FALSE(hasMeshopt()); }

#endif

} // namespace
} // namespace kestrel::gltf_meshopt_test
