// Names of the LED patterns that CiA 303-3 and ETG.1300 define.
#include "stator/base/led_pattern.hpp"

#include <gtest/gtest.h>

namespace stator::base {
namespace {

TEST(LedPattern, HasTheNamesOfTheStandards) {
  EXPECT_EQ(to_text(LedPattern::off), "off");
  EXPECT_EQ(to_text(LedPattern::single_flash), "single flash");
  EXPECT_EQ(to_text(LedPattern::triple_flash), "triple flash");
  EXPECT_EQ(to_text(static_cast<LedPattern>(12)), "12 flashes");
  EXPECT_EQ(to_text(LedPattern::blinking), "blinking");
  EXPECT_EQ(to_text(LedPattern::flickering), "flickering");
  EXPECT_EQ(to_text(LedPattern::on), "on");
  EXPECT_EQ(to_text(static_cast<LedPattern>(16)), "?");
}

}  // namespace
}  // namespace stator::base
