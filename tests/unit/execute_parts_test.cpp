#include "execute/finite.h"
#include "execute/resources.h"
#include "graph/glsl_names.h"
#include <gtest/gtest.h>
#include <limits>

namespace kestrel {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(FirstBadValue, IsTheFirstFromTheTopRowByRow) {
    Image image(4, 3, 2, 0.5F);
    EXPECT_FALSE(firstBadValue(image, -infinity, infinity));
    image.at(1, 2, 0) = std::numeric_limits<float>::infinity();
    image.at(3, 1, 1) = std::numeric_limits<float>::quiet_NaN();
    const auto bad = firstBadValue(image, -infinity, infinity);
    ASSERT_TRUE(bad);
    EXPECT_EQ(bad->x, 3);
    EXPECT_EQ(bad->y, 1);
    EXPECT_EQ(bad->channel, 1);
    EXPECT_EQ(bad->what, "not a number");
    EXPECT_EQ(bad->count, 2u);
    EXPECT_EQ((BadOutput{"a", "b", 3, false, *bad}.text()),
              "pass 'a', port 'b', pixel (3, 1) of layer 3, channel 1: nan is not a number; 2 of its values "
              "are bad");
    image.at(3, 1, 1) = 0;
    EXPECT_EQ(firstBadValue(image, -infinity, infinity)->what, "infinite");
}

TEST(FirstBadValue, HoldsTheRangeWithItsEnds) {
    Image image(3, 1, 1);
    image.values = {0, 1, 1.001F};
    const auto bad = firstBadValue(image, 0, 1);
    ASSERT_TRUE(bad);
    EXPECT_EQ(bad->x, 2);
    EXPECT_EQ(bad->what, "outside [0, 1]");
    image.values[2] = 1;
    EXPECT_FALSE(firstBadValue(image, 0, 1));
}

TEST(BlockName, HasCapitalsForUnderscores) {
    EXPECT_EQ(blockName("depth"), "Depth");
    EXPECT_EQ(blockName("ray_buffer"), "RayBuffer");
    EXPECT_EQ(blockName("x_2_rays"), "X2Rays");
}

TEST(ClearWord, IsTheFloatsBitsOrTheWholeNumber) {
    EXPECT_EQ(clearWord(Desc::buffer(16, Format::R32F), glm::vec4(1)), 0x3f800000U);
    EXPECT_EQ(clearWord(Desc::buffer(16), glm::vec4(7)), 7U);
    EXPECT_EQ(clearWord(Desc::buffer(16, Format::R32UI), glm::vec4(4294967296.0F)), 0xffffffffU);
    EXPECT_EQ(clearWord(Desc::buffer(16, Format::R32I), glm::vec4(-1)), 0xffffffffU);
}

} // namespace
} // namespace kestrel
