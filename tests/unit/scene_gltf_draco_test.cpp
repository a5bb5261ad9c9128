// Primitives that KHR_draco_mesh_compression compresses.
#include "scene/gltf_draco.h"
#include "scene/gltf_import.h"
#include "support/grid_file.h"
#include "support/message.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <random>
#ifdef KESTREL_HAS_DRACO
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#endif

namespace kestrel::gltf_draco_test {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::Grid;
using test::importMessage;
using test::TemporaryFolder;
using testing::HasSubstr;

#ifdef KESTREL_HAS_DRACO

struct Encoded {
    std::vector<std::uint8_t> data;
    size_t points = 0, faces = 0;
    int position = 0, normal = 0, texCoord = 0; // unique ids
};

// `bits` of quantization, 0: none.
Encoded encoded(const Grid& grid, int method, int bits) {
    draco::TriangleSoupMeshBuilder builder;
    const auto faces = static_cast<int>(grid.indices.size() / 3);
    builder.Start(faces);
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const int normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
    const int texCoord = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
    for (int f = 0; f < faces; ++f) {
        const std::uint16_t* corner = grid.indices.data() + 3 * f;
        const auto set = [&](int attribute, const std::vector<float>& values, size_t components) {
            builder.SetAttributeValuesForFace(attribute, draco::FaceIndex(static_cast<std::uint32_t>(f)),
                                              values.data() + components * corner[0],
                                              values.data() + components * corner[1],
                                              values.data() + components * corner[2]);
        };
        set(position, grid.positions, 3);
        set(normal, grid.normals, 3);
        set(texCoord, grid.texCoords, 2);
    }
    const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    if (bits != 0)
        for (const auto type : {draco::GeometryAttribute::POSITION, draco::GeometryAttribute::NORMAL,
                                draco::GeometryAttribute::TEX_COORD})
            encoder.SetAttributeQuantization(type, bits);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    Encoded result;
    result.data.assign(buffer.data(), buffer.data() + buffer.size());
    result.points = mesh->num_points();
    result.faces = mesh->num_faces();
    result.position = static_cast<int>(mesh->attribute(position)->unique_id());
    result.normal = static_cast<int>(mesh->attribute(normal)->unique_id());
    result.texCoord = static_cast<int>(mesh->attribute(texCoord)->unique_id());
    return result;
}

GltfBuilder fileOf(const Encoded& mesh) {
    GltfBuilder builder;
    const size_t view = builder.view(mesh.data);
    json& accessors = builder.document["accessors"];
    for (const char* type : {"VEC3", "VEC3", "VEC2"})
        accessors.push_back({{"componentType", test::Float}, {"count", mesh.points}, {"type", type}});
    accessors.push_back(
        {{"componentType", test::UnsignedShort}, {"count", 3 * mesh.faces}, {"type", "SCALAR"}});
    builder.addMeshNode(
        {{"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}},
         {"indices", 3},
         {"extensions",
          {{"KHR_draco_mesh_compression",
            {{"bufferView", view},
             {"attributes",
              {{"POSITION", mesh.position}, {"NORMAL", mesh.normal}, {"TEXCOORD_0", mesh.texCoord}}}}}}}});
    builder.document["extensionsUsed"] =
        builder.document["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    return builder;
}

// The corners of all triangles by what they are, each triangle from its least corner on, sorted.
struct Corner {
    glm::vec3 position, normal;
    glm::vec2 texCoord;
};
std::vector<std::array<Corner, 3>> trianglesOf(const Primitive& primitive) {
    std::vector<std::array<Corner, 3>> triangles;
    const auto less = [](const Corner& a, const Corner& b) {
        // Rounded, so that quantization does not change the order of a regular grid.
        return std::pair(std::lround(a.texCoord.y * 100), std::lround(a.texCoord.x * 100)) <
               std::pair(std::lround(b.texCoord.y * 100), std::lround(b.texCoord.x * 100));
    };
    for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        std::array<Corner, 3> triangle;
        for (size_t k = 0; k < 3; ++k) {
            const size_t v = primitive.indices[i + k];
            triangle[k] = {primitive.positions[v], primitive.normals[v], primitive.texCoords[v]};
        }
        std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end(), less),
                    triangle.end());
        triangles.push_back(triangle);
    }
    std::sort(triangles.begin(), triangles.end(), [&](const auto& a, const auto& b) {
        for (size_t k = 0; k < 3; ++k) {
            if (less(a[k], b[k])) return true;
            if (less(b[k], a[k])) return false;
        }
        return false;
    });
    return triangles;
}

TEST(GltfDraco, GivesTheSameTrianglesAsThePlainFile) {
    const TemporaryFolder folder;
    const Grid grid(20);
    const auto wanted = trianglesOf(grid.file().import(folder).meshes[0].primitives[0]);
    for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING})
        for (const int bits : {0, 11, 16}) {
            SCOPED_TRACE(testing::Message() << "method " << method << ", bits " << bits);
            const Scene scene = fileOf(encoded(grid, method, bits)).import(folder);
            EXPECT_TRUE(scene.warnings.empty());
            const auto triangles = trianglesOf(scene.meshes[0].primitives[0]);
            ASSERT_EQ(triangles.size(), wanted.size());
            // Half a step of a cube of side 1 along each axis; an octahedron's step is up to twice as long.
            const float step = bits == 0 ? 0.0f : 1.0f / static_cast<float>((1 << bits) - 1);
            for (size_t i = 0; i < triangles.size(); ++i)
                for (size_t k = 0; k < 3; ++k) {
                    EXPECT_LE(glm::length(triangles[i][k].position - wanted[i][k].position),
                              0.9f * step + 1e-6f);
                    EXPECT_LE(glm::length(triangles[i][k].normal - wanted[i][k].normal), 4 * step + 1e-6f);
                    EXPECT_LE(glm::length(triangles[i][k].texCoord - wanted[i][k].texCoord),
                              0.75f * step + 1e-6f);
                }
        }
}

TEST(GltfDraco, PrimitivesMayShareDataAndStandBesidePlainOnes) {
    const TemporaryFolder folder;
    const Grid grid(3);
    GltfBuilder builder = fileOf(encoded(grid, draco::MESH_SEQUENTIAL_ENCODING, 0));
    json shared = builder.document["meshes"][0]["primitives"][0];
    builder.document["meshes"][0]["primitives"].push_back(shared);
    builder.document["meshes"][0]["primitives"].push_back(
        {{"attributes", {{"POSITION", builder.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3)}}}});
    // Draco gives a list of triangles, whatever the mode says, and needs no accessor of indices.
    shared["mode"] = 5;
    shared.erase("indices");
    builder.document["meshes"][0]["primitives"].push_back(shared);
    const std::vector<Primitive> primitives = builder.import(folder).meshes[0].primitives;
    ASSERT_EQ(primitives.size(), 4u);
    EXPECT_EQ(primitives[0], primitives[1]);
    EXPECT_EQ(primitives[2].positions.size(), 3u);
    EXPECT_EQ(primitives[3], primitives[0]);
}

TEST(GltfDraco, SaysWhatIsWrong) {
    const GltfBuilder good = fileOf(encoded(Grid(3), draco::MESH_EDGEBREAKER_ENCODING, 11));
    ASSERT_EQ(importMessage(good), "no error");
    GltfBuilder bad = good;
    json& extension = bad.document["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
    extension["attributes"]["NORMAL"] = 77;
    EXPECT_THAT(importMessage(bad),
                HasSubstr("meshes[0].primitives[0].NORMAL has the number 77 in its Draco data, where "
                          "there is no such attribute"));
    extension["attributes"]["NORMAL"] = extension["attributes"]["TEXCOORD_0"];
    EXPECT_THAT(importMessage(bad), HasSubstr("is not VEC3"));
    extension["attributes"]["NORMAL"] = -1;
    EXPECT_THAT(importMessage(bad), HasSubstr("attributes.NORMAL is -1, which is out of range"));
    bad = good;
    bad.data[0] = 'X';
    EXPECT_THAT(importMessage(bad), HasSubstr("meshes[0].primitives[0] holds no Draco data"));
}

std::string decodeMessage(const std::vector<std::uint8_t>& data) {
    GltfFile file;
    file.path = "d.gltf";
    return test::messageOf([&] { (void)decodeDraco(file, std::as_bytes(std::span(data)), 1 << 20, "it"); });
}

TEST(GltfDraco, EveryTruncationIsAnErrorAndAnyMutationIsSurvived) {
    for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING})
        for (const int bits : {0, 11}) {
            const std::vector<std::uint8_t> whole = encoded(Grid(6), method, bits).data;
            ASSERT_EQ(decodeMessage(whole), "no error");
            for (size_t size = 0; size < whole.size(); ++size)
                EXPECT_NE(decodeMessage({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}),
                          "no error")
                    << size << " of " << whole.size();
            std::mt19937 random(1);
            for (int round = 0; round < 1000; ++round) {
                std::vector<std::uint8_t> bent = whole;
                for (int i = 0; i < 3; ++i)
                    bent[random() % bent.size()] = static_cast<std::uint8_t>(random());
                EXPECT_EQ(decodeMessage(bent).find('\n'), std::string::npos);
            }
            EXPECT_THAT(importMessage(fileOf(encoded(Grid(6), method, bits))), "no error");
        }
}

TEST(GltfDraco, DecompressionIsBounded) {
    for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING}) {
        const GltfBuilder good = fileOf(encoded(Grid(20), method, 11));
        EXPECT_THAT(importMessage(good, {.decodedBytes = 30'000}),
                    HasSubstr("meshes[0].primitives[0] decompresses to "));
        EXPECT_THAT(importMessage(good, {.decodedBytes = 30'000}),
                    HasSubstr("of which 30000 are left for this file"));
        EXPECT_EQ(importMessage(good, {.decodedBytes = 200'000}), "no error");
    }
}

#else

TEST(GltfDraco, IsRefusedByNameWithoutThePackage) { EXPECT_FALSE(hasDraco()); }

#endif

} // namespace
} // namespace kestrel::gltf_draco_test
