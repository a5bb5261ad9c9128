#include "core/progress.h"
#include <gtest/gtest.h>

namespace kestrel {
namespace {

TEST(ProgressLine, ShowsBarShareDetailAndWhatIsLeft) {
    EXPECT_EQ(progressLine("render", 0.5, 4, "frame 3 of 6"),
              "render [###############...............]  50 %  frame 3 of 6, 4 s left");
}

TEST(ProgressLine, SaysNothingOfTheRestAtBothEnds) {
    EXPECT_EQ(progressLine("x", 0, 4, ""), "x [..............................]   0 %");
    EXPECT_EQ(progressLine("x", 2, 4, ""), "x [##############################] 100 %");
}

} // namespace
} // namespace kestrel
