// A stepper axis with chopper, supply and sensors: currents, braking by diodes, equal bits in every
// build.
#include "stator/plant/axes/stepper_axis.hpp"

#include <bit>
#include <cmath>

#include <gtest/gtest.h>

#include "plant/rotating_field.hpp"

namespace stator::plant {
namespace {

using namespace base::literals;

StepperAxisParameters named(const char* motor) {
  StepperAxisParameters parameters;
  parameters.motor = *find_stepper_motor(motor);
  return parameters;
}

constexpr base::AxisActuation kPhaseA{.bridge_enabled = true, .coil_current_target = {3.0, 0.0}};

TEST(StepperAxis, ChopperBringsTheCurrentToItsTargetAsFastAsTheSupplyAllows) {
  StepperAxisParameters parameters = named("QSH5718-55-30-098");
  parameters.supply_voltage = 24.0;
  StepperAxis axis(parameters);
  // 24 V / 2.1 mH = 11.4 A/ms: 3 A take 0.27 ms.
  const double rise = 24.0 / 0.8 * (1.0 - std::exp(-250e-6 * 0.8 / 2.1e-3));
  for (int n = 0; n < 5; ++n) {
    axis.step(kPhaseA, 50_us);
  }
  EXPECT_NEAR(axis.observe().coil_current[0], rise, 1e-6);
  axis.step(kPhaseA, 50_us);
  EXPECT_NEAR(axis.observe().coil_current[0], 3.0, 1e-4);
  axis.step(kPhaseA, 50_us);
  EXPECT_NEAR(axis.observe().coil_current[0], 3.0, 1e-6);
  EXPECT_EQ(axis.observe().coil_current[1], 0.0);
}

TEST(StepperAxis, DisabledBridgeLetsTheCurrentDecayToExactlyZeroAndTheShaftTurnFreely) {
  StepperAxisParameters parameters = named("QSH5718-55-30-098");
  parameters.motor.detent_torque = 0.0;
  parameters.load.constant_torque = 0.5;
  StepperAxis axis(parameters);
  for (int n = 0; n < 2'000; ++n) {
    axis.step(kPhaseA, 50_us);
  }
  EXPECT_NEAR(axis.observe().speed, 0.0, 5.0);
  for (int n = 0; n < 10; ++n) {
    axis.step({}, 50_us);
  }
  EXPECT_EQ(axis.observe().coil_current, (std::array{0.0, 0.0}));
  EXPECT_EQ(axis.observe().electromagnetic_torque, 0.0);
  for (int n = 0; n < 200; ++n) {
    axis.step({}, 50_us);
  }
  EXPECT_GT(axis.observe().speed, 20.0);
}

TEST(StepperAxis, UnpoweredMotorTurnedFasterThanTheSupplyCanBlockIsBrakedThroughItsDiodes) {
  StepperAxisParameters parameters = named("QSH5718-55-30-098");
  parameters.supply_voltage = 5.0;
  StepperAxis axis(parameters);
  axis.set_external_torque(0.2);
  for (int n = 0; n < 40'000; ++n) {
    axis.step({}, 50_us);
  }
  const double blocking_speed = 5.0 / (50 * parameters.motor.flux_linkage);  // EMF peak = supply
  EXPECT_GT(axis.observe().speed, blocking_speed);
  EXPECT_LT(axis.observe().electromagnetic_torque, 0.0);
}

TEST(StepperAxis, BrownOutLeavesTheCurrentBelowItsTarget) {
  StepperAxis axis(named("QSH5718-55-30-098"));
  axis.set_supply_voltage(1.0);
  base::AxisSensing sensing;
  for (int n = 0; n < 2'000; ++n) {
    sensing = axis.step(kPhaseA, 50_us);
  }
  EXPECT_NEAR(sensing.coil_current[0], 1.0 / axis.resistance(), 1e-6);
  EXPECT_EQ(sensing.supply_voltage, 1.0);
}

TEST(StepperAxis, EnablingPullsTheRotorToTheFieldWithinAFullStepPair) {
  StepperAxisParameters parameters = named("QSH5718-55-30-098");
  parameters.motor.viscous_friction = 5e-3;
  parameters.initial_revolutions = 1.5 / 200.0;  // 135 degrees electrical
  StepperAxis axis(parameters);
  for (int n = 0; n < 20'000; ++n) {
    axis.step(kPhaseA, 50_us);
  }
  // Friction may hold the rotor asin(Ts / (holding torque at 3 A + 4 Td)) off.
  EXPECT_NEAR(axis.observe().shaft_revolutions, 0.0, 1.0 / 51'200);
}

TEST(StepperAxis, EncoderAndSwitchesFollowTheShaft) {
  StepperAxisParameters parameters = named("QSH5718-55-30-098");
  parameters.right_switch = PositionSwitch::right_at(1.5);
  parameters.left_switch = PositionSwitch::left_at(-1.5);
  parameters.home_switch = PositionSwitch::home_between(0.9, 1.1);
  StepperAxis axis(parameters);
  RotatingField field(axis, 4.2);
  field.run(0.25, 4.0 * base::kTwoPi);
  field.run(0.875);  // 0.125 + 0.875 revolutions
  EXPECT_NEAR(static_cast<double>(axis.sense().encoder_count), 40'000.0, 40.0);
  EXPECT_EQ(
      axis.sense().encoder_count,
      static_cast<std::int64_t>(std::floor(axis.observe().shaft_revolutions * 40'000.0 + 0.5)));
  EXPECT_TRUE(axis.sense().home_switch);
  EXPECT_FALSE(axis.sense().right_switch);
  field.run(1.0);
  EXPECT_TRUE(axis.sense().right_switch);
  EXPECT_FALSE(axis.sense().left_switch);
  EXPECT_FALSE(axis.sense().home_switch);
  EXPECT_EQ(axis.sense().encoder_index_passages, 2U);
  EXPECT_EQ(axis.sense().encoder_index_count, 80'000);
}

TEST(StepperAxis, LongStepsAreDividedSoThatTheyAgreeWithShortOnes) {
  StepperAxisParameters parameters = named("QSH5718-55-30-098");
  parameters.load.brake_torque = 10.0;
  parameters.supply_voltage = 1.0;
  StepperAxis one(parameters);
  StepperAxis many(parameters);
  base::AxisActuation actuation = kPhaseA;
  actuation.brake_released = false;
  one.step(actuation, 300_us);
  for (int n = 0; n < 6; ++n) {
    many.step(actuation, 50_us);
  }
  EXPECT_NEAR(one.observe().coil_current[0], many.observe().coil_current[0], 1e-6);
}

/// FNV-1a over the bits of the state.
std::uint64_t fingerprint(const StepperAxis& axis) {
  const HybridStepperState& state = axis.state().motor;
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::uint64_t word :
       {std::bit_cast<std::uint64_t>(state.current[0]),
        std::bit_cast<std::uint64_t>(state.current[1]), std::bit_cast<std::uint64_t>(state.speed),
        std::bit_cast<std::uint64_t>(state.angle.angle),
        static_cast<std::uint64_t>(state.angle.periods),
        static_cast<std::uint64_t>(axis.sense().encoder_count)}) {
    hash = (hash ^ word) * 0x100000001b3;
  }
  return hash;
}

std::uint64_t fingerprint_of_a_run() {
  StepperAxisParameters parameters = named("QSH5718-55-30-098");
  parameters.load.coulomb_friction = 0.02;
  parameters.load.unbalance_torque = 0.1;
  parameters.load.end_stop_maximum = 3.5;
  StepperAxis axis(parameters);
  RotatingField field(axis, 4.2);
  std::uint64_t hash = 0;
  for (const double acceleration : {60.0, 0.0, -120.0, 0.0, 300.0}) {
    for (int n = 0; n < 8'000; ++n) {
      field.step(acceleration);
      hash = hash * 31 + fingerprint(axis);
    }
  }
  return hash;
}

TEST(StepperAxis, SameRunIsTheSameToTheLastBitInEveryBuild) {
  const std::uint64_t hash = fingerprint_of_a_run();
  EXPECT_EQ(hash, fingerprint_of_a_run());
  // Seen with GCC 12 and Clang 14 at -O0 and -O3, for SSE2 and AVX-512. A deliberate change of the
  // model changes it; a difference between two builds of the same source is a defect.
  EXPECT_EQ(hash, 16'401'758'581'393'263'252U) << "the model or its arithmetic has changed";
}

TEST(StepperAxis, StandingStillIsLeftAtOnceByWhateverActsOnTheShaft) {
  // `woken` forgets before each step that it stands still, so it computes each of them.
  StepperAxis axis(named("QSH5718-55-30-098"));
  StepperAxis woken(named("QSH5718-55-30-098"));
  const auto both = [&](const base::AxisActuation& actuation, int steps) {
    for (int n = 0; n < steps; ++n) {
      axis.step(actuation, 50_us);
      woken.restore(woken.state());
      woken.step(actuation, 50_us);
      ASSERT_EQ(axis.state().motor, woken.state().motor) << "step " << n;
    }
  };
  both(kPhaseA, 4'000);
  EXPECT_EQ(axis.observe().speed, 0.0);
  const double at_rest = axis.observe().shaft_angle;

  axis.set_external_torque(0.5);
  woken.set_external_torque(0.5);
  both(kPhaseA, 400);
  EXPECT_GT(axis.observe().shaft_angle, at_rest);

  axis.set_external_torque(0.0);
  woken.set_external_torque(0.0);
  both(kPhaseA, 4'000);
  both({.bridge_enabled = true, .coil_current_target = {0.0, 3.0}}, 400);
  axis.set_supply_voltage(0.0);
  woken.set_supply_voltage(0.0);
  both({}, 400);
}

TEST(StepperAxis, RestoredStateContinuesIdentically) {
  StepperAxis axis(named("QSH5718-55-30-098"));
  RotatingField field(axis, 4.2);
  field.run(0.3, 30.0);
  StepperAxis copy(named("QSH5718-55-30-098"));
  copy.restore(axis.state());
  for (int n = 0; n < 1'000; ++n) {
    const base::AxisActuation actuation{.bridge_enabled = n % 300 < 200,
                                        .coil_current_target = {0.01 * n, -2.0}};
    axis.step(actuation, 50_us);
    copy.step(actuation, 50_us);
    ASSERT_EQ(fingerprint(axis), fingerprint(copy));
  }
}

// A hand, a script or a fuzzer may set any torque: the world stays finite.
TEST(StepperAxis, ATorqueBeyondAllReasonEndsAtTheBurstingSpeed) {
  StepperAxis axis(StepperAxisParameters{});
  axis.set_external_torque(-1'000.0);
  for (int n = 0; n < 200; ++n) {
    axis.step({.bridge_enabled = true, .coil_current_target = {2.0, 0.0}}, 100_us);
    ASSERT_TRUE(std::isfinite(axis.sensing().coil_current[0]));
    ASSERT_GE(axis.observe().speed, -1e4);
  }
  EXPECT_EQ(axis.observe().speed, -1e4);
  axis.set_external_torque(0.0);
  for (int n = 0; n < 20'000; ++n) {
    axis.step({}, 50_us);
  }
  EXPECT_GT(axis.observe().speed, -10.0) << "friction stops what is left alone";
}

}  // namespace
}  // namespace stator::plant
