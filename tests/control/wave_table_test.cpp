// The TMCM-142's sine table of 8192 entries, its offset, and full steps on arrival.
#include "stator/control/motion_controller/wave_table.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "stator/base/trigonometry.hpp"

namespace stator::control::motion_controller {
namespace {

TEST(WaveTable, AMicrostepIsAsManyEntriesAsItsResolutionSays) {
  for (std::uint8_t index = 0; index <= 11; ++index) {
    WaveTable table;
    table.load(index, 0);
    const std::int64_t microsteps = 2048 >> index;  // per full step, A26
    table.advance(microsteps);
    EXPECT_EQ(table.position(), 2048) << int{index};
    table.advance(-2 * microsteps);
    EXPECT_EQ(table.position(), 6144) << int{index};
    table.advance(5 * microsteps);
    EXPECT_EQ(table.position(), 0) << int{index};
  }
}

TEST(WaveTable, HasSineAndCosineOf8192Entries) {
  const WaveTable table;
  for (int entry = 0; entry < WaveTable::kSize; ++entry) {
    ASSERT_NEAR(table.wave(entry), std::sin(base::kTwoPi * entry / 8192.0), 1e-12) << entry;
  }
  WaveTable turned;
  turned.set_position(1'024);
  EXPECT_NEAR(turned.phases()[0], std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(turned.phases()[1], std::sqrt(0.5), 1e-12);
}

TEST(WaveTable, TheOffsetStepsAtZeroCrossingsAndLeavesThePeak) {
  WaveTable table;
  table.load(0, 128);  // 128 / 1024 of the amplitude
  EXPECT_EQ(table.wave(0), 0.0);
  EXPECT_NEAR(table.wave(1), 0.125, 0.001);
  EXPECT_NEAR(table.wave(-1), -0.125, 0.001);
  EXPECT_NEAR(table.wave(4'095), 0.125, 0.001);
  EXPECT_EQ(table.wave(4'096), 0.0);
  EXPECT_NEAR(table.wave(4'097), -0.125, 0.001);
  EXPECT_NEAR(table.wave(2'048), 1.0, 1e-15);
  EXPECT_NEAR(table.wave(6'144), -1.0, 1e-15);
}

TEST(WaveTable, ThePointerCanBeSet) {
  WaveTable table;
  table.load(0, 0);
  table.advance(-3);
  EXPECT_EQ(table.position(), 8'189);
  table.set_position(100);
  EXPECT_EQ(table.position(), 100);
  table.advance(1);
  EXPECT_EQ(table.position(), 101);
}

TEST(WaveTable, FullStepsAreMetOnArrival) {
  EXPECT_EQ(full_steps_met(0, 2'047), 0);
  EXPECT_EQ(full_steps_met(2'047, 2'048), 1);
  EXPECT_EQ(full_steps_met(2'048, 2'047), 0);
  EXPECT_EQ(full_steps_met(2'049, 2'048), 1);
  EXPECT_EQ(full_steps_met(-1, 0), 1);
  EXPECT_EQ(full_steps_met(1, -4'096), 3);
}

}  // namespace
}  // namespace stator::control::motion_controller
