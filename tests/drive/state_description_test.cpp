// The state that a statusword shows, and the names of modes of operation.
#include "stator/drive/power/state_description.hpp"

#include <gtest/gtest.h>

namespace stator::drive {
namespace {

TEST(PowerStateOfStatusword, IsTheStateThatMadeIt) {
  for (const PowerState state : kPowerStates) {
    const std::uint16_t word = statusword_of(state);
    EXPECT_EQ(power_state_of(word), state) << to_text(state).view();
    // Voltage enabled, warning, remote and what follows say nothing about the state.
    EXPECT_EQ(power_state_of(static_cast<std::uint16_t>(word | 0xFF90)), state)
        << to_text(state).view();
  }
  EXPECT_EQ(power_state_of(0x0040), PowerState::switch_on_disabled);
  EXPECT_EQ(power_state_of(0x0060), PowerState::switch_on_disabled);
  EXPECT_FALSE(power_state_of(0x0003)) << "quick stop with Switch on only";
}

TEST(ModeName, IsTheStandards) {
  EXPECT_EQ(mode_name(8), "cyclic synchronous position");
  EXPECT_EQ(mode_name(6), "homing");
  EXPECT_EQ(mode_name(-1), "manufacturer specific");
  EXPECT_EQ(mode_name(100), "reserved");
}

}  // namespace
}  // namespace stator::drive
