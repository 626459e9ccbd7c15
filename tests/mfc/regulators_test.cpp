// Settings, ramp-up and protection of the chip's voltage regulators.
#include "stator/mfc/units/regulators.hpp"

#include <gmock/gmock.h>

namespace stator::mfc {
namespace {

using namespace base::literals;

constexpr base::SimTime at(base::SimDuration time) {
  return base::SimTime(time);
}

TEST(Regulators, DecodeTheirSettings) {
  const std::uint16_t saw[] = {250, 125, 500, 1000};
  const std::uint16_t oscillator[] = {240, 130, 470, 890};
  const std::uint16_t percent[] = {100, 150, 200, 50};
  for (unsigned code = 0; code < 4; ++code) {
    Regulators regulators;
    regulators.configure({}, static_cast<std::uint16_t>(code << 8 | (code ^ 1U) << 2 | 0x40));
    EXPECT_EQ(regulators.adjustable().saw_kilohertz, saw[code]);
    EXPECT_EQ(regulators.adjustable().oscillator_kilohertz, oscillator[code]);
    EXPECT_TRUE(regulators.adjustable().over_current_protection);
    EXPECT_EQ(regulators.fixed().saw_kilohertz, 250);
    EXPECT_EQ(regulator_percent(regulators.fixed().amplification_code), percent[code ^ 1U]);
    EXPECT_FALSE(regulators.fixed().over_current_protection);
  }
}

TEST(Regulators, RampUpInAMillisecond) {
  Regulators regulators;
  regulators.set_adjustable_target(12'000, 24'000);
  EXPECT_EQ(regulators.fixed_voltage(at(500_us)), 1650);
  EXPECT_EQ(regulators.fixed_voltage(at(2_ms)), 3300);
  regulators.configure(at(3_ms), 0x8000);
  EXPECT_EQ(regulators.adjustable_voltage(at(4_ms)), 0);
  regulators.configure(at(5_ms), 0);
  EXPECT_EQ(regulators.adjustable_voltage(at(5250_us)), 3000);
  EXPECT_EQ(regulators.adjustable_voltage(at(6_ms)), 12'000);
}

TEST(Regulators, AdjustableOneStaysBetweenItsReferenceAndTheSupply) {
  Regulators regulators;
  regulators.set_adjustable_target(30'000, 24'000);
  EXPECT_EQ(regulators.adjustable_voltage(at(1_s)), 24'000);
  regulators.set_adjustable_target(100, 24'000);
  EXPECT_EQ(regulators.adjustable_voltage(at(1_s)), 1200);
}

TEST(Regulators, ShortsShowOnlyWithTheirProtection) {
  Regulators regulators;
  regulators.set_fixed_short(true);
  regulators.set_adjustable_short(true);
  EXPECT_TRUE(regulators.fixed_short_flag());
  EXPECT_TRUE(regulators.adjustable_short_flag());
  regulators.configure({}, 0x4040);
  EXPECT_FALSE(regulators.fixed_short_flag());
  EXPECT_FALSE(regulators.adjustable_short_flag());
  EXPECT_EQ(regulators.fixed_voltage(at(1_s)), 0);
}

TEST(Regulators, HeatSwitchesTheAdjustableOneOff) {
  Regulators regulators;
  regulators.set_adjustable_target(5000, 24'000);
  regulators.set_adjustable_overheated(at(1_s), true);
  EXPECT_TRUE(regulators.adjustable_overheated_flag());
  EXPECT_EQ(regulators.adjustable_voltage(at(1_s)), 0);
  regulators.set_adjustable_overheated(at(2_s), false);
  EXPECT_EQ(regulators.adjustable_voltage(at(2_s)), 0);
  EXPECT_EQ(regulators.adjustable_voltage(at(3_s)), 5000);
}

}  // namespace
}  // namespace stator::mfc
