#include "stator/plant/mechanics/mechanical_load.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "stator/plant/axes/stepper_axis.hpp"

namespace stator::plant {
namespace {

using namespace base::literals;

/// A motor switched off, without detent, on which the load acts alone.
StepperAxisParameters unpowered() {
  StepperAxisParameters parameters;
  parameters.motor = *find_stepper_motor("QSH5718-55-30-098");
  parameters.motor.detent_torque = 0.0;
  parameters.motor.viscous_friction = 0.0;
  parameters.motor.coulomb_friction = 0.0;
  parameters.motor.static_friction = 0.0;
  return parameters;
}

void run(StepperAxis& axis, double seconds, const base::AxisActuation& actuation = {}) {
  for (int n = 0; n < static_cast<int>(seconds / 50e-6 + 0.5); ++n) {
    axis.step(actuation, 50_us);
  }
}

TEST(MechanicalLoad, ConstantTorqueAcceleratesRotorAndLoad) {
  StepperAxisParameters parameters = unpowered();
  parameters.load.inertia = 1e-4;
  parameters.load.constant_torque = -0.01;
  StepperAxis axis(parameters);
  run(axis, 0.1);
  const double expected = -0.01 / (1e-4 + parameters.motor.rotor_inertia) * 0.1;
  EXPECT_NEAR(axis.observe().speed, expected, 1e-9);
  EXPECT_EQ(axis.observe().load_torque, -0.01);
}

TEST(MechanicalLoad, ExternalTorqueActsFromWhenItIsSet) {
  StepperAxis axis(unpowered());
  run(axis, 0.01);
  EXPECT_EQ(axis.observe().speed, 0.0);
  axis.set_external_torque(0.02);
  run(axis, 0.01);
  EXPECT_NEAR(axis.observe().speed, 0.02 / 2.09e-5 * 0.01, 1e-9);
}

TEST(MechanicalLoad, AbsurdTorqueKeepsTheNumbersFinite) {
  StepperAxis axis(unpowered());
  axis.set_external_torque(1e6);
  run(axis, 0.01);
  EXPECT_LE(axis.observe().speed, 1e4);
  EXPECT_TRUE(std::isfinite(axis.observe().shaft_angle));
  axis.set_external_torque(-1e6);
  run(axis, 0.01);
  EXPECT_GE(axis.observe().speed, -1e4);
  EXPECT_GE(axis.state().motor.angle.angle, 0.0);
  EXPECT_LT(axis.state().motor.angle.angle, base::kTwoPi);
}

TEST(MechanicalLoad, PendulumSwingsWithItsFrequencyAroundTheBottom) {
  StepperAxisParameters parameters = unpowered();
  parameters.load.inertia = 1e-3;
  parameters.load.unbalance_torque = 0.1;
  parameters.initial_revolutions = 7.01;
  StepperAxis axis(parameters);
  const double period = base::kTwoPi * std::sqrt((1e-3 + parameters.motor.rotor_inertia) / 0.1);
  run(axis, 0.5 * period);
  EXPECT_NEAR(axis.observe().shaft_revolutions, 6.99, 1e-4);
  run(axis, 0.5 * period);
  EXPECT_NEAR(axis.observe().shaft_revolutions, 7.01, 1e-4);
}

TEST(MechanicalLoad, EndStopHoldsAgainstTorqueWithItsStiffness) {
  StepperAxisParameters parameters = unpowered();
  parameters.load.constant_torque = 0.1;
  parameters.load.end_stop_maximum = 2.0;
  parameters.load.end_stop_minimum = -1.0;
  StepperAxis axis(parameters);
  run(axis, 2.0);
  const double pressed_in = 0.1 / parameters.load.end_stop_stiffness;  // rad
  EXPECT_NEAR(axis.observe().shaft_angle, 2.0 * base::kTwoPi + pressed_in, 1e-6);
  EXPECT_NEAR(axis.observe().load_torque, 0.0, 1e-6);
  axis.set_external_torque(-0.2);
  run(axis, 2.0);
  EXPECT_NEAR(axis.observe().shaft_angle, -base::kTwoPi - pressed_in, 1e-6);
}

TEST(MechanicalLoad, EndStopNeverPulls) {
  StepperAxisParameters parameters = unpowered();
  parameters.load.end_stop_maximum = 0.0;
  parameters.load.end_stop_damping = 1.0;  // would pull back strongly if it could
  parameters.initial_revolutions = 0.0001;
  StepperAxis axis(parameters);
  axis.set_external_torque(-1.0);
  for (int n = 0; n < 400; ++n) {
    axis.step({}, 50_us);
    ASSERT_LE(axis.observe().load_torque, -1.0 + 1e-12);
  }
  EXPECT_LT(axis.observe().shaft_revolutions, 0.0);
}

TEST(MechanicalLoad, BrakeHoldsTheShaftUntilReleased) {
  StepperAxisParameters parameters = unpowered();
  parameters.load.constant_torque = -0.2;
  parameters.load.brake_torque = 0.5;
  StepperAxis axis(parameters);
  run(axis, 0.1, {.brake_released = false});
  EXPECT_EQ(axis.observe().shaft_angle, 0.0);
  run(axis, 0.05, {.brake_released = true});
  EXPECT_LT(axis.observe().speed, -100.0);
  run(axis, 0.2, {.brake_released = false});
  EXPECT_EQ(axis.observe().speed, 0.0);
}

}  // namespace
}  // namespace stator::plant
