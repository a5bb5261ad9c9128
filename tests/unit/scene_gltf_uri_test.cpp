// What URIs in glTF files lead to: data in the text, files inside the folder, files outside it.
#include "scene/gltf_import.h"
#include "support/gltf_builder.h"
#include "support/message.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel::gltf_uri_test {
namespace {

using test::GltfBuilder;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

// One red pixel.
const std::vector<std::uint8_t>& png() {
    static const std::vector<std::uint8_t> bytes = {
        137, 80, 78, 71, 13, 10, 26,  10,  0,  0,   0,  13, 73, 72, 68, 82, 0,  0,  0,   1,   0,  0,   0,
        1,   8,  2,  0,  0,  0,  144, 119, 83, 222, 0,  0,  0,  12, 73, 68, 65, 84, 120, 218, 99, 248, 207,
        192, 0,  0,  3,  1,  1,  0,   247, 3,  65,  67, 0,  0,  0,  0,  73, 69, 78, 68,  174, 66, 96,  130};
    return bytes;
}

std::string percentEncoded(std::span<const unsigned char> bytes) {
    constexpr const char* digits = "0123456789ABCDEF";
    std::string text;
    for (const unsigned char byte : bytes) {
        text += '%';
        text += digits[byte >> 4];
        text += digits[byte & 15];
    }
    return text;
}

std::string percentEncoded(const std::string& text) {
    return percentEncoded({reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

GltfBuilder triangleAt(const std::string& uri) {
    GltfBuilder builder = test::triangleFile();
    builder.document["buffers"] = {{{"byteLength", builder.data.size()}, {"uri", uri}}};
    return builder;
}

GltfBuilder texturedBy(const std::string& uri) {
    GltfBuilder builder = test::triangleFile();
    builder.document["images"] = {{{"uri", uri}}};
    builder.document["textures"] = {{{"source", 0}}};
    builder.document["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    builder.document["meshes"][0]["primitives"][0]["material"] = 0;
    return builder;
}

void write(const std::filesystem::path& file, std::span<const unsigned char> bytes) {
    writeFile(file, std::as_bytes(bytes));
}

TEST(GltfUri, DataIsPercentDecodedBeforeAnythingElse) {
    const TemporaryFolder folder;
    const std::vector<unsigned char> data = test::triangleFile().data;
    const std::string coded = test::base64(data);
    for (const std::string& uri :
         {"data:application/octet-stream;base64," + coded,
          "data:application/octet-stream;base64," + percentEncoded(coded), "DATA:;Base64," + coded,
          "data:a/b;charset=x%3Bbase64," + coded, "data:application/octet-stream," + percentEncoded(data),
          "data:," + percentEncoded(data)}) {
        SCOPED_TRACE(uri);
        const Scene scene = triangleAt(uri).import(folder);
        EXPECT_THAT(scene.meshes[0].primitives[0].positions,
                    ElementsAre(glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)));
        EXPECT_TRUE(scene.warnings.empty());
    }
    const Scene scene = texturedBy("data:image/png," + percentEncoded(png())).import(folder);
    ASSERT_EQ(scene.images.size(), 1u);
    EXPECT_THAT(scene.images[0].rgba, ElementsAre(255, 0, 0, 255));
}

TEST(GltfUri, BrokenDataSaysWhatIsWrong) {
    const TemporaryFolder folder;
    const auto message = [&](const std::string& uri) {
        return test::messageOf([&] { (void)triangleAt(uri).import(folder); });
    };
    EXPECT_THAT(message("data:;base64"), HasSubstr("buffers[0] has a data URI without a comma"));
    EXPECT_THAT(message("data:;base64,A%21AA"), HasSubstr("buffers[0] has a data URI with broken base64"));
    EXPECT_THAT(message("data:,%00%01"), HasSubstr("but its data has 2 bytes"));
}

// models/m.gltf names what lies in textures/ beside its folder, or in a folder that links there.
struct Project {
    TemporaryFolder folder;
    explicit Project(const GltfBuilder& builder) {
        write(folder / "textures/a.png", png());
        write(folder / "textures/a.bin", test::triangleFile().data);
        writeFile(folder / "models/m.gltf", builder.text());
        std::filesystem::create_directory_symlink("../textures", folder / "models/linked");
    }
    [[nodiscard]] Scene import(bool allowOutside) const {
        return importGltf(folder / "models/m.gltf", {.allowOutside = allowOutside});
    }
};

TEST(GltfUri, ABufferOutsideTheFolderNeedsTheSwitchThatTheMessageNames) {
    for (const char* uri :
         {"../textures/a.bin", "x/../../textures/a.bin", "linked/a.bin", "%2e%2e/textures/a.bin"}) {
        SCOPED_TRACE(uri);
        const Project project(triangleAt(uri));
        const std::string message = test::messageOf([&] { (void)project.import(false); });
        EXPECT_THAT(message, HasSubstr(std::string("buffers[0]: '") + uri +
                                       "' leaves the folder of the scene (--allow-outside lets it be read)"));
        if (uri[0] != 'x') {
            EXPECT_EQ(project.import(true).meshes[0].primitives[0].positions.size(), 3u);
        }
    }
}

TEST(GltfUri, AnImageOutsideTheFolderIsLeftOutAndTheRestLoads) {
    for (const char* uri : {"../textures/a.png", "linked/a.png"}) {
        SCOPED_TRACE(uri);
        const Project project(texturedBy(uri));
        const Scene without = project.import(false);
        EXPECT_TRUE(without.images.empty());
        EXPECT_FALSE(without.materials[0].baseColourTexture.present());
        EXPECT_THAT(without.warnings,
                    ElementsAre(std::string("images[0]: '") + uri +
                                "' leaves the folder of the scene (--allow-outside lets it be read) and is "
                                "left out"));
        const Scene with = project.import(true);
        EXPECT_EQ(with.images.size(), 1u);
        EXPECT_TRUE(with.materials[0].baseColourTexture.present());
        EXPECT_TRUE(with.warnings.empty());
    }
}

TEST(GltfUri, AbsolutePathsNeedTheSwitchToo) {
    const TemporaryFolder elsewhere;
    write(elsewhere / "a.bin", test::triangleFile().data);
    const std::string path = (elsewhere / "a.bin").string();
    for (const std::string& uri : {path, "file://" + path, "file://localhost" + path, "file:" + path}) {
        SCOPED_TRACE(uri);
        const Project project(triangleAt(uri));
        EXPECT_THAT(test::messageOf([&] { (void)project.import(false); }), HasSubstr("--allow-outside"));
        EXPECT_EQ(project.import(true).meshes[0].primitives[0].positions.size(), 3u);
    }
    EXPECT_THAT(test::messageOf([] { (void)Project(triangleAt("http://a.b/c.bin")).import(true); }),
                HasSubstr("buffers[0] is at 'http://a.b/c.bin'; only files are read"));
}

TEST(GltfUri, PathsWithDotsInsideTheFolderNeedNoSwitch) {
    const TemporaryFolder folder;
    write(folder / "parts/a.bin", test::triangleFile().data);
    std::filesystem::create_directory_symlink("parts", folder / "linked");
    for (const char* uri : {"parts/../parts/./a.bin", "linked/a.bin"})
        EXPECT_EQ(triangleAt(uri).import(folder).meshes[0].primitives[0].positions.size(), 3u) << uri;
}

TEST(GltfUri, ASceneThatIsNamedThroughALinkFindsWhatLiesBesideIt) {
    const TemporaryFolder folder, elsewhere;
    write(folder / "a.bin", test::triangleFile().data);
    writeFile(folder / "m.gltf", triangleAt("a.bin").text());
    std::filesystem::create_symlink(folder / "m.gltf", elsewhere / "link.gltf");
    EXPECT_EQ(importGltf(elsewhere / "link.gltf").meshes[0].primitives[0].positions.size(), 3u);
}

} // namespace
} // namespace kestrel::gltf_uri_test
