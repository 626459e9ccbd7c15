// Stop switches of the TMCM-142: polarity, swap, status bits, latches.
#include "stator/control/motion_controller/stop_switches.hpp"

#include <gtest/gtest.h>

namespace stator::control::motion_controller {
namespace {

StopSwitches with(const SwitchSettings& settings) {
  StopSwitches switches;
  switches.configure(settings);
  return switches;
}

TEST(StopSwitches, AreActiveLowUntilThePolarityBitsSayOtherwise) {
  StopSwitches switches;
  switches.sample(false, true);
  EXPECT_TRUE(switches.left());
  EXPECT_FALSE(switches.right());
  switches.configure({.mode = switch_mode::kLeftActiveHigh});
  switches.sample(false, true);
  EXPECT_FALSE(switches.left());
  EXPECT_FALSE(switches.right());
  switches.configure({.mode = switch_mode::kRightActiveHigh});
  switches.sample(false, true);
  EXPECT_TRUE(switches.left());
  EXPECT_TRUE(switches.right());
}

TEST(StopSwitches, SwapExchangesThePinsAfterTheirPolarity) {
  StopSwitches switches = with({.mode = switch_mode::kSwap | switch_mode::kLeftActiveHigh});
  switches.sample(true, true);
  EXPECT_TRUE(switches.right()) << "pin REF_L, active high";
  EXPECT_FALSE(switches.left()) << "pin REF_R, active low";
}

TEST(StopSwitches, StatusHasTheBitsOfTheDocument) {
  StopSwitches switches;
  switches.sample(true, true);
  EXPECT_EQ(switches.status(), 0U);
  switches.sample(false, true);
  EXPECT_EQ(switches.status(), 0x11U);
  switches.sample(true, false);
  EXPECT_EQ(switches.status(), 0x22U);
  switches.configure({.right_disabled = true});
  EXPECT_EQ(switches.status(), 0x02U) << "the state stays readable";
  EXPECT_EQ(switches.stops(), StopConditions{});
  switches.configure({.left_disabled = true});
  switches.sample(false, false);
  EXPECT_EQ(switches.status(), 0x23U);
  EXPECT_EQ(switches.stops(), (StopConditions{.left = false, .right = true}));
}

TEST(StopSwitches, EachEdgeLatchesIfItsBitIsSet) {
  struct Case {
    std::uint32_t bit;
    bool left_before, right_before, left_after, right_after;
    std::uint32_t ready;
  };
  // Pins: false is active.
  const Case cases[] = {
      {switch_mode::kLatchLeftActive, true, true, false, true, 0x4},
      {switch_mode::kLatchLeftInactive, false, true, true, true, 0x4},
      {switch_mode::kLatchRightActive, true, true, true, false, 0x8},
      {switch_mode::kLatchRightInactive, true, false, true, true, 0x8},
  };
  for (const Case& armed : cases) {
    for (const Case& edge : cases) {
      StopSwitches switches = with({.mode = armed.bit});
      EXPECT_FALSE(switches.sample(edge.left_before, edge.right_before));
      const bool same = armed.bit == edge.bit;
      EXPECT_EQ(switches.sample(edge.left_after, edge.right_after), same);
      EXPECT_EQ(switches.status() & 0xCU, same ? armed.ready : 0U);
      EXPECT_FALSE(switches.sample(edge.left_after, edge.right_after));
    }
  }
}

TEST(StopSwitches, ReadingClearsTheLatchEventsOnly) {
  StopSwitches switches = with({.mode = switch_mode::kLatchLeftActive});
  switches.sample(true, true);
  switches.sample(false, true);
  EXPECT_EQ(switches.read_status(), 0x15U);
  EXPECT_EQ(switches.read_status(), 0x11U);
}

}  // namespace
}  // namespace stator::control::motion_controller
