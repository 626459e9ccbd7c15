// Broken and grounded cables, jams and sensor faults of an axis driven by PWM, for each kind of
// motor.
#include <array>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "plant/commutated_pwm_axis.hpp"

namespace stator::plant {
namespace {

using namespace base::literals;

constexpr base::SimDuration kPeriod = kCommutationPeriod;

void coast(PwmAxis& axis, double seconds) {
  for (auto n = std::llround(seconds * 50e3); n > 0; --n) {
    axis.step({}, kPeriod);
  }
}

class PwmAxisFaultsOf : public testing::TestWithParam<InverterModel> {
 protected:
  static PwmAxis axis_of(PwmAxisParameters parameters) {
    parameters.inverter_model = GetParam();
    return PwmAxis(parameters);
  }
};
INSTANTIATE_TEST_SUITE_P(Inverter, PwmAxisFaultsOf,
                         testing::Values(InverterModel::averaged, InverterModel::switched),
                         [](const auto& tested) {
                           return tested.param == InverterModel::switched ? "Switched" : "Averaged";
                         });

TEST_P(PwmAxisFaultsOf, ABrokenCableCarriesNoCurrentAndAThreePhaseMotorRunsOnTheOthers) {
  PwmAxis axis = axis_of(three_phase_axis());
  run(axis, 0.02, 2.0);
  axis.set_faults({.terminals = {.open = {false, true}}});
  run(axis, 0.02, 3.0);
  for (int n = 0; n < 100; ++n) {
    run(axis, 20e-6, 3.0);
    ASSERT_NEAR(axis.currents()[1], 0.0, 1e-9);
    ASSERT_NEAR(axis.currents()[0], -axis.currents()[2], 1e-9);
  }
  EXPECT_GT(axis.speed(), 10.0);
  coast(axis, 0.001);
  EXPECT_NEAR(axis.currents()[1], 0.0, 1e-9);
}

TEST_P(PwmAxisFaultsOf, ABrokenCableTakesTheCurrentOfItsWindingOnly) {
  PwmAxis axis = axis_of(stepper_axis());
  axis.step({.bridge_enabled = true, .duty = {0.6, 0.4, 0.6, 0.4}}, 1_ms);
  ASSERT_GT(axis.currents()[0], 0.1);
  axis.set_faults({.terminals = {.open = {false, true, false, false}}});
  axis.step({.bridge_enabled = true, .duty = {0.6, 0.4, 0.6, 0.4}}, 1_ms);
  EXPECT_EQ(axis.currents()[0], 0.0);
  EXPECT_GT(axis.currents()[2], 0.1);
  PwmAxis brushed = axis_of(dc_axis());
  brushed.set_faults({.terminals = {.open = {true}}});
  run(brushed, 0.01, 12.0);
  EXPECT_EQ(brushed.currents()[0], 0.0);
  EXPECT_EQ(brushed.speed(), 0.0);
}

TEST_P(PwmAxisFaultsOf, AGroundedTerminalIsReportedWhileTheBridgeIsOn) {
  PwmAxis axis = axis_of(three_phase_axis());
  axis.set_faults({.terminals = {.grounded = {false, false, true}}});
  run(axis, 20e-6, 3.0);
  EXPECT_EQ(axis.sensing().overcurrent, (std::array{false, false, true, false}));
  axis.step({}, kPeriod);
  EXPECT_EQ(axis.sensing().overcurrent, (std::array<bool, 4>{}));
  axis.set_faults({.high_side = true});
  run(axis, 0.02, 3.0);
  EXPECT_TRUE(axis.sensing().overcurrent_high_side);
  EXPECT_EQ(axis.speed(), 0.0);
}

TEST_P(PwmAxisFaultsOf, GroundedTerminalsBrakeATurningShaftEvenWithTheBridgeOff) {
  for (const PwmAxisParameters& p : {three_phase_axis(), stepper_axis(), dc_axis()}) {
    PwmAxis axis = axis_of(p);
    run(axis, 0.1, 6.0);
    const double speed = axis.speed();
    ASSERT_GT(speed, 10.0);
    PwmAxis sound = axis;
    axis.set_faults({.terminals = {.grounded = {true, true, true, true}}});
    coast(axis, 0.03);
    coast(sound, 0.03);
    EXPECT_LT(axis.speed(), 0.5 * sound.speed());
  }
}

TEST_P(PwmAxisFaultsOf, OneGroundedTerminalOfADcMotorConductsInOneDirectionOnly) {
  // The EMF drives a current through the short and the other terminal's lower diode, or none.
  for (const double volts : {12.0, -12.0}) {
    PwmAxis axis = axis_of(dc_axis());
    run(axis, 0.1, volts);
    coast(axis, 0.005);
    ASSERT_EQ(axis.currents()[0], 0.0);
    axis.set_faults({.terminals = {.grounded = {true, false}}});
    coast(axis, 0.002);
    if (volts > 0.0) {
      const double emf = axis.speed() * 0.035;
      EXPECT_NEAR(axis.currents()[0], -(emf - 0.7) / 0.6, 0.15 * emf / 0.6);
    } else {
      EXPECT_EQ(axis.currents()[0], 0.0);
    }
  }
}

TEST_P(PwmAxisFaultsOf, AJammedShaftStandsAndAFreedOneTurns) {
  for (const PwmAxisParameters& p : {three_phase_axis(), stepper_axis(), dc_axis()}) {
    PwmAxis axis = axis_of(p);
    run(axis, 0.05, 4.0);
    ASSERT_GT(axis.speed(), 10.0);
    axis.set_faults({.common = {.shaft = {.jamming_torque = 5.0}}});
    run(axis, 0.005, 4.0);
    EXPECT_EQ(axis.speed(), 0.0);
    EXPECT_GT(std::fabs(axis.observe().quadrature_current), 1.0);
    axis.set_faults({});
    run(axis, 0.05, 4.0);
    EXPECT_GT(axis.speed(), 10.0);
  }
}

TEST(PwmAxisFaults, AStuckHallReadsTheSameAndSwappedWiresChangeTheOrder) {
  PwmAxis axis(three_phase_axis());
  axis.set_faults({.halls = {HallFault::stuck_low, HallFault::none, HallFault::stuck_high}});
  axis.step({}, kPeriod);
  EXPECT_EQ(axis.sensing().halls, 0b100);  // the magnet along phase U: 001
  axis.set_faults({.halls_swapped = true});
  axis.step({}, kPeriod);
  EXPECT_EQ(axis.sensing().halls, 0b010);
  axis.set_faults({});
  axis.step({}, kPeriod);
  EXPECT_EQ(axis.sensing().halls, 0b001);
}

TEST(PwmAxisFaults, ALostEncoderChannelFreezesTheCountAndAfterRepairItGoesOnFromThere) {
  PwmAxisParameters p = three_phase_axis();
  p.encoders[1] = {.counts_per_revolution = 1000};
  PwmAxis axis(p);
  run(axis, 0.1, 3.0);
  const std::int64_t frozen = axis.sensing().encoders[1].count;
  axis.set_faults({.common = {.encoders = {{{}, {.lost = true}}}}});
  run(axis, 0.05, 3.0);
  EXPECT_EQ(axis.sensing().encoders[1].count, frozen);
  EXPECT_NEAR(static_cast<double>(axis.sensing().encoders[0].count), 4096.0 * axis.revolutions(),
              1.0);
  const double at_repair = axis.revolutions();
  axis.set_faults({});
  run(axis, 0.05, 3.0);
  const double turned = axis.revolutions() - at_repair;
  EXPECT_NEAR(static_cast<double>(axis.sensing().encoders[1].count - frozen), turned * 1000.0, 2.0);
}

TEST(PwmAxisFaults, LostCountsStayLostUntilTheIndexShowsThem) {
  PwmAxis axis(three_phase_axis());
  run(axis, 0.1, 3.0);
  axis.lose_encoder_counts(0, 100);
  run(axis, 0.1, 3.0);
  const EncoderReading& reading = axis.sensing().encoders[0];
  EXPECT_NEAR(static_cast<double>(reading.count), axis.revolutions() * 4096.0 - 100.0, 1.0);
  EXPECT_EQ((reading.index_count + 100) % 4096, 0);
}

TEST(PwmAxisFaults, WithoutItsIndexChannelNoPassageIsSeen) {
  PwmAxis axis(three_phase_axis());
  axis.set_faults({.common = {.encoders = {{{.index_lost = true}, {}}}}});
  run(axis, 0.2, 3.0);
  ASSERT_GT(axis.revolutions(), 2.0);
  EXPECT_EQ(axis.sensing().encoders[0].index_passages, 0U);
  axis.set_faults({});
  const auto before = static_cast<std::uint32_t>(axis.revolutions());
  run(axis, 0.2, 3.0);
  const auto after = static_cast<std::uint32_t>(axis.revolutions());
  EXPECT_EQ(axis.sensing().encoders[0].index_passages, after - before);
}

TEST(PwmAxisFaults, ASaggingSupplyTakesTheSpeedAndItsReturnGivesItBack) {
  PwmAxisParameters p = three_phase_axis();
  p.supply = {.capacitance = 470e-6, .source_resistance = 0.05};
  PwmAxis axis(p);
  run(axis, 0.3, 6.0);
  const double speed = axis.speed();
  axis.set_supply_voltage(12.0);
  run(axis, 0.3, 6.0);  // duties for 24 V
  EXPECT_NEAR(axis.supply_voltage(), 12.0, 0.2);
  EXPECT_LT(axis.speed(), 0.6 * speed);
  axis.set_supply_voltage(24.0);
  run(axis, 0.3, 6.0);
  EXPECT_NEAR(axis.speed(), speed, 0.01 * speed);
}

TEST(PwmAxisSwitches, FollowTheShaftAndTheHand) {
  PwmAxisParameters p = three_phase_axis();
  p.left_switch = PositionSwitch::left_at(-1.0);
  p.right_switch = PositionSwitch::right_at(0.5);
  p.home_switch = PositionSwitch::home_between(0.1, 0.2);
  p.home_switch.normally_closed = true;
  PwmAxis axis(p);
  EXPECT_FALSE(axis.sensing().left_switch);
  EXPECT_FALSE(axis.sensing().right_switch);
  EXPECT_TRUE(axis.sensing().home_switch);
  bool seen = false;
  while (axis.revolutions() < 0.6) {
    run(axis, 20e-6, 3.0);
    const double at = axis.revolutions();
    ASSERT_EQ(axis.sensing().home_switch, at < 0.1 || at > 0.2) << at;
    ASSERT_EQ(axis.sensing().right_switch, at >= 0.5) << at;
    seen = seen || !axis.sensing().home_switch;
  }
  EXPECT_TRUE(seen);
  axis.press_left_switch(true);
  EXPECT_TRUE(axis.sensing().left_switch);
  axis.press_left_switch(false);
  axis.press_right_switch(true);
  axis.press_home_switch(true);
  run(axis, 20e-6, 3.0);
  EXPECT_FALSE(axis.sensing().left_switch);
  EXPECT_TRUE(axis.sensing().right_switch);
  EXPECT_FALSE(axis.sensing().home_switch);
}

TEST(PwmAxisSwitches, AnOpenInputIsPressedByHandAllTheSame) {
  PwmAxis axis(three_phase_axis());
  EXPECT_FALSE(axis.sensing().home_switch);
  axis.press_home_switch(true);
  axis.step({}, kPeriod);
  EXPECT_TRUE(axis.sensing().home_switch);
}

}  // namespace
}  // namespace stator::plant
