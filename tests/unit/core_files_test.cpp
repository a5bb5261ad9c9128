// Reading what the user names, and writing so that nobody sees half a file.
#include "core/files.h"
#include "support/message.h"
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

} // namespace
} // namespace kestrel
