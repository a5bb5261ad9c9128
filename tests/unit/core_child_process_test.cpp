#include "core/child_process.h"
#include "core/error.h"
#include <gtest/gtest.h>

namespace kestrel {
namespace {

std::vector<std::string> bash(const std::string& script) { return {"/bin/bash", "-c", script}; }

TEST(ChildProcess, TalksInLines) {
    ChildProcess child(bash("while read -u 3 line; do echo \"got $line\" >&4; done; exit 7"));
    ASSERT_TRUE(child.send("one"));
    EXPECT_EQ(child.receive(10), "got one");
    ASSERT_TRUE(child.send("two words"));
    EXPECT_EQ(child.receive(10), "got two words");
}

TEST(ChildProcess, TellsHowItEnded) {
    ChildProcess left(bash("echo last >&4; echo so long; echo farewell >&2; exit 7"));
    EXPECT_EQ(left.receive(10), "last");
    EXPECT_EQ(left.receive(10), std::nullopt);
    EXPECT_FALSE(left.timedOut());
    EXPECT_EQ(left.ending(), "exit status 7");
    EXPECT_EQ(left.exitStatus(), 7);
    EXPECT_EQ(left.said(), "so long\nfarewell\n");
    ChildProcess crashed(bash("kill -SEGV $$"));
    EXPECT_EQ(crashed.receive(10), std::nullopt);
    EXPECT_EQ(crashed.ending().substr(0, 9), "signal 11");
    EXPECT_EQ(crashed.exitStatus(), -1);
    EXPECT_FALSE(crashed.send("to nobody"));
}

TEST(ChildProcess, EndsWhatTakesTooLong) {
    ChildProcess child(bash("echo here >&4; sleep 100"));
    EXPECT_EQ(child.receive(10), "here");
    EXPECT_EQ(child.receive(0.2), std::nullopt);
    EXPECT_TRUE(child.timedOut());
    EXPECT_EQ(child.ending().substr(0, 8), "signal 9");
}

TEST(ChildProcess, AProgramThatIsNotThereEndsAtOnce) {
    ChildProcess child({"/nowhere/program"});
    EXPECT_EQ(child.receive(10), std::nullopt);
    EXPECT_EQ(child.ending(), "exit status 127");
}

TEST(ChildProcess, OutputWithoutEndIsKeptInPart) {
    ChildProcess child(bash("head -c 1000000 /dev/zero | tr '\\0' x; echo done >&4"));
    EXPECT_EQ(child.receive(10), "done");
    child.ending();
    EXPECT_EQ(child.said(), std::string(4096, 'x'));
}

} // namespace
} // namespace kestrel
