// When a value meets what a scenario expects, and how numbers are written.
#include "stator/scenario/comparison.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace stator::scenario {
namespace {

TEST(Comparison, TakesWhatIsNearEnough) {
  const Comparison near{.equals = 10.0, .tolerance = 0.5};
  EXPECT_TRUE(near.met(10.5));
  EXPECT_TRUE(near.met(9.5));
  EXPECT_FALSE(near.met(10.6));
  EXPECT_EQ(near.text("mm"), "is 10 ± 0.5 mm");
}

TEST(Comparison, AsksForAllAtOnce) {
  const Comparison between{.above = 1.0, .below = 2.0};
  EXPECT_TRUE(between.met(1.5));
  EXPECT_FALSE(between.met(1.0));
  EXPECT_FALSE(between.met(2.0));
  EXPECT_EQ(between.text(), "is above 1 and below 2");
  EXPECT_FALSE((Comparison{.differs = 3.0}.met(3.0)));
  EXPECT_TRUE((Comparison{.differs = 3.0}.met(3.5)));
}

TEST(Comparison, NothingIsMetByEverythingButNan) {
  EXPECT_TRUE(Comparison{}.empty());
  EXPECT_TRUE(Comparison{}.met(5.0));
  EXPECT_FALSE((Comparison{.equals = 0.0}.met(std::nan(""))));
  EXPECT_FALSE((Comparison{.above = 0.0}.met(std::nan(""))));
}

TEST(NumberText, WritesWholeNumbersWithoutExponent) {
  EXPECT_EQ(number_text(25'600'000.0), "25600000");
  EXPECT_EQ(number_text(0.125, "V"), "0.125 V");
  EXPECT_EQ(number_text(-3.0), "-3");
}

}  // namespace
}  // namespace stator::scenario
