// Files from the world: real scenes load, a corpus of odd ones loads or is refused in one line.
#include "core/error.h"
#include "scene/geometry.h"
#include "scene/scene.h"
#include "support/assets.h"
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

void expectFinite(const Scene& scene) {
    for (const double time : {0.0, 0.5 * scene.duration(), scene.duration()}) {
        const Geometry geometry = flatten(scene, time);
        for (const glm::vec3& position : geometry.positions)
            ASSERT_TRUE(std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(position.z));
        for (const VertexAttributes& vertex : geometry.attributes) {
            ASSERT_NEAR(glm::length(vertex.normal), 1, 1e-5);
            ASSERT_FALSE(
                std::isnan(vertex.tangent.x + vertex.tangent.y + vertex.tangent.z + vertex.tangent.w));
        }
        for (const std::uint32_t index : geometry.indices) ASSERT_LT(index, geometry.positions.size());
    }
}

TEST(GltfCorpus, RealScenesLoad) {
    const std::filesystem::path assets = test::assetsFolder();
    if (assets.empty()) GTEST_SKIP() << "no folder of real scenes";
    for (const std::filesystem::path& file : test::gltfFilesBelow(assets)) {
        SCOPED_TRACE(file.string());
        const Scene scene = loadScene(file.string());
        EXPECT_GT(flatten(scene, 0).triangleCount(), 0u);
        expectFinite(scene);
    }
}

// How Debian's assimp-testmodels 5.2.5 behaves, read file by file: glTF 1.0 (7 files), schema errors, indices
// out of range, cycles, infinite positions, a missing buffer and required extensions are refused.
TEST(GltfCorpus, AssimpModelsLoadOrAreRefused) {
    const std::vector<std::filesystem::path> files = test::gltfFilesBelow("/usr/share/assimp/models");
    if (files.empty()) GTEST_SKIP() << "assimp-testmodels is not installed";
    int loaded = 0, refused = 0;
    for (const std::filesystem::path& file : files) {
        SCOPED_TRACE(file.string());
        try {
            expectFinite(loadScene(file.string()));
            ++loaded;
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr(file.filename().string()));
            EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
            ++refused;
        }
    }
    RecordProperty("loaded", loaded);
    RecordProperty("refused", refused);
    EXPECT_GE(loaded, 31);
    EXPECT_GE(refused, 21); // without Draco one more
}

TEST(GltfCorpus, AssimpModelsAreRefusedForTheirReason) {
    const std::filesystem::path folder = "/usr/share/assimp/models/glTF2";
    if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "assimp-testmodels is not installed";
    for (const auto& [file, reason] :
         {std::pair("IndexOutOfRange/IndexOutOfRange.gltf", "has the index 255, but 24 vertices"),
          std::pair("BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb", "is infinite at element 0"),
          std::pair("RecursiveNodes/RecursiveNodes.gltf", "the hierarchy has a cycle"),
          std::pair("MissingBin/BoxTextured.gltf", "'BoxTextured0.bin' no such file"),
          std::pair("SchemaFailures/sceneWrongType.gltf", "scene is not a number"),
          std::pair("BoxTextured-glTF-techniqueWebGL/BoxTextured.gltf", "KHR_technique_webgl")}) {
        try {
            loadScene((folder / file).string());
            ADD_FAILURE() << file << " loads";
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr(reason));
        }
    }
}

} // namespace
} // namespace kestrel
