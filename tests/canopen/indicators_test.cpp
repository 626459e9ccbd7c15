// Which patterns the RUN and ERROR LEDs of a CANopen device show (CiA 303-3).
#include "stator/canopen/nmt/indicators.hpp"

#include <gtest/gtest.h>

namespace stator::canopen {
namespace {

using base::LedPattern;

TEST(CanopenIndicators, OfRunShowTheNmtState) {
  EXPECT_EQ(run_led(NmtState::initialisation), LedPattern::off);
  EXPECT_EQ(run_led(NmtState::pre_operational), LedPattern::blinking);
  EXPECT_EQ(run_led(NmtState::stopped), LedPattern::single_flash);
  EXPECT_EQ(run_led(NmtState::operational), LedPattern::on);
}

TEST(CanopenIndicators, OfErrorShowTheWorst) {
  EXPECT_EQ(error_led({}), LedPattern::off);
  EXPECT_EQ(error_led({.warning_limit_reached = true}), LedPattern::single_flash);
  EXPECT_EQ(error_led({.error_control_event = true, .warning_limit_reached = true}),
            LedPattern::double_flash);
  EXPECT_EQ(error_led({.bus_off = true, .error_control_event = true}), LedPattern::on);
}

}  // namespace
}  // namespace stator::canopen
