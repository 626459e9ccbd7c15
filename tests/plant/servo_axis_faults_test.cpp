// Broken, shorted and grounded cables and sensor faults of a servo axis.
#include <cmath>

#include <gtest/gtest.h>

#include "plant/ideal_commutator.hpp"
#include "stator/plant/axes/servo_axis.hpp"

namespace stator::plant {
namespace {

using namespace base::literals;

void run(ServoAxis& axis, double milliseconds, double quadrature) {
  base::ServoActuation actuation{.bridge_enabled = true};
  for (int n = 0; n < static_cast<int>(milliseconds * 20.0); ++n) {
    actuation.duty = commutated(axis, 0.0, quadrature);
    axis.step(actuation, 50_us);
  }
}

TEST(ServoAxisFaults, ABrokenCableCarriesNoCurrentAndTheMotorRunsOnTheOthers) {
  ServoAxis axis(textbook_axis());
  run(axis, 20.0, 2.0);
  axis.set_faults({.open = {false, true, false}});
  run(axis, 20.0, 3.0);
  for (int n = 0; n < 100; ++n) {
    run(axis, 0.05, 3.0);
    ASSERT_NEAR(axis.sensing().phase_current[1], 0.0, 1e-9);
    ASSERT_NEAR(axis.sensing().phase_current[0], -axis.sensing().phase_current[2], 1e-9);
  }
  EXPECT_GT(axis.observe().speed, 10.0);
  EXPECT_EQ(axis.sensing().overcurrent, (std::array<bool, 3>{}));
}

TEST(ServoAxisFaults, WithTwoBrokenCablesNothingFlows) {
  ServoAxis axis(textbook_axis());
  axis.set_faults({.open = {true, true, false}});
  run(axis, 20.0, 3.0);
  EXPECT_EQ(axis.sensing().phase_current, (std::array<double, 3>{}));
  EXPECT_EQ(axis.observe().speed, 0.0);
}

TEST(ServoAxisFaults, AShortedPhaseIsReportedWhileTheBridgeIsOn) {
  ServoAxis axis(textbook_axis());
  axis.set_faults({.shorted = {false, false, true}});
  run(axis, 0.05, 3.0);
  EXPECT_EQ(axis.sensing().overcurrent, (std::array{false, false, true}));
  axis.step({}, 50_us);
  EXPECT_EQ(axis.sensing().overcurrent, (std::array<bool, 3>{}));
}

TEST(ServoAxisFaults, AShortInTheStageTakesTheVoltageFromAllPhases) {
  ServoAxis axis(textbook_axis());
  axis.set_faults({.high_side = true});
  run(axis, 20.0, 3.0);
  EXPECT_TRUE(axis.sensing().overcurrent_high_side);
  EXPECT_EQ(axis.observe().speed, 0.0);
}

TEST(ServoAxisFaults, GroundedCablesBrakeATurningShaftEvenWithTheBridgeOff) {
  ServoAxis axis(textbook_axis());
  run(axis, 200.0, 5.0);
  const double speed = axis.observe().speed;
  axis.set_faults({.shorted = {true, true, true}});
  for (int n = 0; n < 2000; ++n) {
    axis.step({}, 50_us);
  }
  EXPECT_LT(axis.observe().speed, 0.1 * speed);
}

TEST(ServoAxisFaults, AStuckHallReadsTheSameAndSwappedWiresChangeTheOrder) {
  ServoAxisParameters parameters = textbook_axis();
  ServoAxis axis(parameters);
  axis.set_faults({.halls = {HallFault::stuck_low, HallFault::none, HallFault::stuck_high}});
  axis.step({}, 50_us);
  EXPECT_EQ(axis.sensing().halls, 0b100);  // the magnet along phase U: 001
  axis.set_faults({.halls_swapped = true});
  axis.step({}, 50_us);
  EXPECT_EQ(axis.sensing().halls, 0b010);
  axis.set_faults({});
  axis.step({}, 50_us);
  EXPECT_EQ(axis.sensing().halls, 0b001);
}

TEST(ServoAxisFaults, ALostEncoderChannelFreezesTheCountAndAfterRepairItGoesOnFromThere) {
  ServoAxis axis(textbook_axis());
  run(axis, 100.0, 3.0);
  const std::int64_t frozen = axis.sensing().encoder_count;
  axis.set_faults({.common = {.encoders = {{{.lost = true}, {}}}}});
  run(axis, 50.0, 3.0);
  EXPECT_EQ(axis.sensing().encoder_count, frozen);
  const double at_repair = axis.observe().shaft_revolutions;
  axis.set_faults({});
  run(axis, 50.0, 3.0);
  const double turned = axis.observe().shaft_revolutions - at_repair;
  EXPECT_NEAR(static_cast<double>(axis.sensing().encoder_count - frozen), turned * 4096.0, 2.0);
}

TEST(ServoAxisFaults, LostCountsStayLostUntilTheIndexShowsThem) {
  ServoAxis axis(textbook_axis());
  run(axis, 100.0, 3.0);
  axis.lose_encoder_counts(100);
  run(axis, 100.0, 3.0);
  EXPECT_NEAR(static_cast<double>(axis.sensing().encoder_count),
              axis.observe().shaft_revolutions * 4096.0 - 100.0, 1.0);
  // The index lies at count 0 of the disc: a drive that latches there finds the loss.
  EXPECT_EQ((axis.sensing().encoder_index_count + 100) % 4096, 0);
}

TEST(ServoAxisFaults, WithoutItsIndexChannelNoPassageIsSeen) {
  ServoAxis axis(textbook_axis());
  axis.set_faults({.common = {.encoders = {{{.index_lost = true}, {}}}}});
  run(axis, 200.0, 3.0);
  ASSERT_GT(axis.observe().shaft_revolutions, 2.0);
  EXPECT_EQ(axis.sensing().encoder_index_passages, 0U);
  axis.set_faults({});
  const auto before = static_cast<std::uint32_t>(axis.observe().shaft_revolutions);
  run(axis, 200.0, 3.0);
  const auto after = static_cast<std::uint32_t>(axis.observe().shaft_revolutions);
  EXPECT_EQ(axis.sensing().encoder_index_passages, after - before);
}

}  // namespace
}  // namespace stator::plant
