// Where limit and home switches are pressed, and what a normally closed or open input reads.
#include "stator/plant/sensors/position_switch.hpp"

#include <gtest/gtest.h>

namespace stator::plant {
namespace {

TEST(PositionSwitch, LeftIsPressedAtAndBelowItsPosition) {
  constexpr PositionSwitch kLeft = PositionSwitch::left_at(-2.0);
  EXPECT_FALSE(kLeft.level(-1.999));
  EXPECT_TRUE(kLeft.level(-2.0));
  EXPECT_TRUE(kLeft.level(-100.0));
}

TEST(PositionSwitch, RightIsPressedAtAndAboveItsPosition) {
  constexpr PositionSwitch kRight = PositionSwitch::right_at(3.0);
  EXPECT_FALSE(kRight.level(2.999));
  EXPECT_TRUE(kRight.level(3.0));
}

TEST(PositionSwitch, HomeIsPressedWithinItsRange) {
  constexpr PositionSwitch kHome = PositionSwitch::home_between(-0.1, 0.1);
  EXPECT_FALSE(kHome.level(-0.2));
  EXPECT_TRUE(kHome.level(0.0));
  EXPECT_FALSE(kHome.level(0.2));
}

TEST(PositionSwitch, NormallyClosedContactInvertsTheLevel) {
  PositionSwitch left = PositionSwitch::left_at(0.0);
  left.normally_closed = true;
  EXPECT_FALSE(left.level(-1.0));
  EXPECT_TRUE(left.level(1.0));
}

TEST(PositionSwitch, AHandPressesBesidesTheCam) {
  PositionSwitch home = PositionSwitch::home_between(-0.1, 0.1);
  EXPECT_TRUE(home.level(0.5, true));
  EXPECT_TRUE(home.level(0.0, true));
  home.normally_closed = true;
  EXPECT_FALSE(home.level(0.5, true));
  EXPECT_TRUE(PositionSwitch{}.level(0.5, true)) << "a wire at an open input";
  EXPECT_FALSE(PositionSwitch{.level_if_not_fitted = true}.level(0.5, true));
}

TEST(PositionSwitch, OpenInputReadsItsRestLevelEverywhere) {
  EXPECT_FALSE(PositionSwitch{}.level(0.0));
  EXPECT_TRUE(PositionSwitch{.level_if_not_fitted = true}.level(0.0));
}

}  // namespace
}  // namespace stator::plant
