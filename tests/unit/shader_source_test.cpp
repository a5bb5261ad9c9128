#include "core/error.h"
#include "core/files.h"
#include "shader/source.h"
#include "support/message.h"
#include "support/temporary_folder.h"
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fs = std::filesystem;

namespace kestrel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A folder that exists as long as the test.
class ShaderFolder : public testing::Test {
protected:
    void write(const std::string& path, std::string_view text) const { writeFile(folder / path, text); }
    static std::string messageOf(ShaderLibrary& library, const std::string& path) {
        return test::messageOf([&] { library.text(path); });
    }
    test::TemporaryFolder own;
    const fs::path& folder = own.path();
};

TEST(ShaderStageOf, ReadsTheEnding) {
    EXPECT_EQ(shaderStageOf("a/b.vert"), ShaderStage::Vertex);
    EXPECT_EQ(shaderStageOf("a/b.geom"), ShaderStage::Geometry);
    EXPECT_EQ(shaderStageOf("a/b.frag"), ShaderStage::Fragment);
    EXPECT_EQ(shaderStageOf("a/b.comp"), ShaderStage::Compute);
    EXPECT_EQ(shaderStageOf("lib/tracer.glsl"), std::nullopt);
}

TEST_F(ShaderFolder, TheFirstFolderWinsAndAVirtualFileBeforeAll) {
    write("one/lib/a.glsl", "one a\r\nend\r\n");
    write("two/lib/a.glsl", "two a");
    write("two/lib/b.glsl", "two b");
    ShaderLibrary library({folder / "one"});
    library.addFolder(folder / "two");
    EXPECT_EQ(library.text("lib/a.glsl"), "one a\nend\n");
    EXPECT_EQ(library.text("lib/b.glsl"), "two b");
    EXPECT_EQ(library.locate("lib/b.glsl"), folder / "two/lib/b.glsl");
    library.addVirtual("lib/b.glsl", "virtual b");
    EXPECT_EQ(library.text("lib/b.glsl"), "virtual b");
    EXPECT_EQ(library.locate("lib/b.glsl"), std::nullopt);
    EXPECT_THAT(library.paths(), ElementsAre("lib/a.glsl", "lib/b.glsl"));
}

TEST_F(ShaderFolder, AMissingFileIsNamedWithTheFoldersAndTheNearName) {
    write("lib/tracer.glsl", "");
    ShaderLibrary library({folder});
    EXPECT_EQ(messageOf(library, "lib/trcer.glsl"),
              "no shader file 'lib/trcer.glsl' (did you mean 'lib/tracer.glsl'?); searched " +
                  folder.string());
    ShaderLibrary none;
    EXPECT_EQ(messageOf(none, "lib/a.glsl"), "no shader file 'lib/a.glsl'; searched no folder");
}

TEST_F(ShaderFolder, APathCannotLeaveTheFolders) {
    write("outside.glsl", "secret");
    write("inside/a.glsl", "");
    ShaderLibrary library({folder / "inside"});
    EXPECT_THAT(messageOf(library, "../outside.glsl"), HasSubstr("is not a path inside a shader folder"));
    EXPECT_THAT(messageOf(library, (folder / "outside.glsl").string()),
                HasSubstr("is not a path inside a shader folder"));
}

TEST_F(ShaderFolder, ChangedDropsWhatChangedAndNothingElse) {
    write("a.glsl", "old");
    write("b.glsl", "same");
    ShaderLibrary library({folder});
    library.text("a.glsl");
    const std::string* b = library.find("b.glsl");
    EXPECT_FALSE(library.changed());

    write("a.glsl", "newer"); // another size
    EXPECT_TRUE(library.changed());
    EXPECT_EQ(library.text("a.glsl"), "newer");
    EXPECT_EQ(library.find("b.glsl"), b);
    EXPECT_FALSE(library.changed());

    write("a.glsl", "final"); // the same size: only the time tells
    fs::last_write_time(folder / "a.glsl", fs::last_write_time(folder / "a.glsl") + std::chrono::seconds(2));
    EXPECT_TRUE(library.changed());
    EXPECT_EQ(library.text("a.glsl"), "final");

    fs::remove(folder / "a.glsl");
    EXPECT_TRUE(library.changed());
    EXPECT_EQ(library.find("a.glsl"), nullptr);
}

TEST_F(ShaderFolder, ChangedSeesFilesThatAppear) {
    write("two/a.glsl", "two");
    fs::create_directories(folder / "one");
    ShaderLibrary library({folder / "one", folder / "two"});
    EXPECT_EQ(library.text("a.glsl"), "two");
    EXPECT_EQ(library.find("b.glsl"), nullptr);
    EXPECT_FALSE(library.changed());
    write("one/a.glsl", "one"); // hides the other
    EXPECT_TRUE(library.changed());
    EXPECT_EQ(library.text("a.glsl"), "one");
    write("two/b.glsl", "b"); // was asked for in vain
    EXPECT_TRUE(library.changed());
    EXPECT_EQ(library.text("b.glsl"), "b");
    EXPECT_FALSE(library.changed());
}

} // namespace
} // namespace kestrel
