// Reading what the user names, and writing so that nobody sees half a file.
#include "core/files.h"
#include "support/message.h"
#include <algorithm>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace kestrel {
namespace {

namespace fs = std::filesystem;
using test::messageOf;
using testing::HasSubstr;

class CoreFiles : public testing::Test {
protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path folder_ = fs::temp_directory_path() / ("kestrel_files_" + std::to_string(::getpid()));
};

TEST_F(CoreFiles, APipeIsReadToItsEnd) {
    const fs::path pipe = folder_ / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    const std::string text(200'000, 'x'); // more than a pipe holds
    std::thread writer([&] { std::ofstream(pipe) << text; });
    EXPECT_EQ(readGivenText(pipe), text);
    writer.join();
    std::thread again([&] { std::ofstream(pipe) << std::string(2000, 'x'); }); // all of which a pipe holds
    EXPECT_THAT(messageOf([&] { readGivenText(pipe, 1000); }), HasSubstr("has more than the 1000 bytes"));
    again.join();
    EXPECT_THAT(messageOf([&] { readText(pipe); }), HasSubstr("is not a file"))
        << "what a stranger's file names is no pipe";
}

TEST_F(CoreFiles, APipeIsWrittenAsItIs) {
    const fs::path pipe = folder_ / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    std::string read;
    std::thread reader([&] { read = readGivenText(pipe); });
    writeFile(pipe, "text");
    reader.join();
    EXPECT_EQ(read, "text");
    EXPECT_TRUE(fs::is_fifo(pipe)) << "it stays what it was";
    EXPECT_FALSE(isStream(folder_));
}

TEST_F(CoreFiles, ALinkStaysALink) {
    writeFile(folder_ / "there" / "a.txt", "before");
    fs::create_symlink(folder_ / "there" / "a.txt", folder_ / "link");
    writeFile(folder_ / "link", "after");
    EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
    EXPECT_EQ(readText(folder_ / "there" / "a.txt"), "after");
}

TEST_F(CoreFiles, WhatCannotBeWrittenIsToldBeforeAndNothingIsLeftBehind) {
    writeFile(folder_ / "file", "text");
    requireWritable(folder_ / "new" / "deep" / "x.png");
    requireWritable(folder_ / "file");
    requireWritableFolder(folder_ / "new");
    EXPECT_FALSE(fs::exists(folder_ / "new"));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
    const std::string file = (folder_ / "file").string();
    EXPECT_EQ(messageOf([&] { requireWritable(folder_ / "file" / "x" / "y.png"); }),
              file + "/x: cannot be written: " + file + " is not a folder");
    EXPECT_EQ(messageOf([&] { requireWritable(folder_); }),
              folder_.string() + ": cannot be written: it is a folder");
    EXPECT_THAT(messageOf([&] { requireWritable("/proc/none/x.png"); }),
                HasSubstr("/proc/none: cannot be written"));
}

std::vector<std::string> namesIn(const fs::path& folder) {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

std::vector<std::byte> someBytes(std::size_t count) { return std::vector<std::byte>(count, std::byte{'x'}); }

TEST_F(CoreFiles, WhatIsWrittenReplacesTheWholeFileAndLeavesNothingBeside) {
    for (const char* text : {"first", "second"}) {
        writeFile(folder_ / "a", text);
        EXPECT_EQ(readText(folder_ / "a"), text);
    }
    EXPECT_THAT(namesIn(folder_), testing::ElementsAre("a"));
    const fs::perms ours = fs::status(folder_ / "a").permissions();
    std::ofstream(folder_ / "b") << "by others";
    EXPECT_EQ(ours, fs::status(folder_ / "b").permissions());
}

TEST_F(CoreFiles, OfSeveralFilesNoneIsWrittenWhereOneCannotBe) {
    writeFile(folder_ / "a", "before");
    const FileBytes good{{folder_ / "a", someBytes(3)}, {folder_ / "new" / "b", someBytes(4)}};
    FileBytes bad = good;
    bad.emplace_back("/dev/full", someBytes(5));
    EXPECT_EQ(messageOf([&] { writeFiles(bad); }), "/dev/full: cannot be written: No space left on device");
    EXPECT_EQ(readText(folder_ / "a"), "before");
    EXPECT_FALSE(fs::exists(folder_ / "new" / "b"));
    writeFiles(good);
    EXPECT_EQ(readText(folder_ / "a"), "xxx");
    EXPECT_EQ(readText(folder_ / "new" / "b"), "xxxx");
    EXPECT_THAT(namesIn(folder_), testing::ElementsAre("a", "new"));
    EXPECT_THAT(namesIn(folder_ / "new"), testing::ElementsAre("b"));
}

TEST_F(CoreFiles, MoreFilesThanAProcessMayHoldOpenAreWritten) {
    FileBytes files;
    for (int i = 0; i < 2000; ++i) files.emplace_back(folder_ / std::to_string(i), someBytes(1));
    for (int round = 0; round < 2; ++round) {
        writeFiles(files);
        EXPECT_EQ(namesIn(folder_).size(), files.size());
    }
}

} // namespace
} // namespace kestrel
