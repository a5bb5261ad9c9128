#include "core/spin.h"
#include <gtest/gtest.h>

namespace kestrel {
namespace {

TEST(Spin, MeasuresBothCases) {
    const SpinTest spin = measureSpin();
    // How long it takes is the machine's own affair.
    EXPECT_GT(spin.oneThreadMs, 0);
    EXPECT_GT(spin.twoThreadsMs, 0);
}

} // namespace
} // namespace kestrel
