// The DC motor's equations against their analytic solutions: winding, no-load speed, friction.
#include "stator/plant/motors/dc_motor.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"

namespace stator::plant {
namespace {

DcMotorParameters frictionless() {
  DcMotorParameters motor;
  motor.viscous_friction = 0.0;
  motor.coulomb_friction = 0.0;
  motor.static_friction = 0.0;
  return motor;
}

TEST(DcMotor, BlockedShaftFollowsTheExponentialOfItsWinding) {
  DcMotorParameters parameters;
  parameters.static_friction = 100.0;
  parameters.coulomb_friction = 100.0;
  DcMotor motor(parameters, {});
  DcMotorState state = motor.at(0.0);
  for (int n = 0; n < 50; ++n) {
    motor.step(state, {.voltage = 3.0}, 20e-6);
  }
  const double rate = parameters.resistance / parameters.inductance;
  EXPECT_NEAR(state.current, 3.0 / parameters.resistance * (1.0 - std::exp(-rate * 1e-3)), 1e-12);
  EXPECT_EQ(state.speed, 0.0);
}

TEST(DcMotor, OneStepOf20MicrosecondsEqualsSixtyFourShorterOnes) {
  DcMotor coarse(frictionless(), {});
  DcMotor fine(frictionless(), {});
  DcMotorState a = coarse.at(0.0);
  DcMotorState b = a;
  base::Random random(3);
  double worst = 0.0;
  for (int n = 0; n < 5'000; ++n) {
    const DcMotorInput input{.voltage = 24.0 * random.uniform() - 8.0,
                             .torque = 0.02 * random.uniform()};
    coarse.step(a, input, 20e-6);
    for (int k = 0; k < 64; ++k) {
      fine.step(b, input, 20e-6 / 64);
    }
    worst = std::max(worst, std::fabs(a.current - b.current));
  }
  EXPECT_LT(worst / coarse.motor().rated_current, 1e-9);
  EXPECT_NEAR(a.speed, b.speed, 1e-6);
  EXPECT_GT(std::fabs(a.speed), 100.0);
}

TEST(DcMotor, NoLoadSpeedIsWhereTheEmfLeavesWhatFrictionTakes) {
  const DcMotorParameters parameters;
  DcMotor motor(parameters, {});
  DcMotorState state = motor.at(0.0);
  for (int n = 0; n < 100'000; ++n) {
    motor.step(state, {.voltage = 24.0}, 20e-6);
  }
  const double k = parameters.torque_constant;
  const double r = parameters.resistance;
  const double b = parameters.viscous_friction;
  const double expected = (k * 24.0 / r - parameters.coulomb_friction) / (k * k / r + b);
  EXPECT_NEAR(state.speed, expected, 1e-4 * expected);
}

TEST(DcMotor, DryFrictionBringsTheShaftToExactlyZero) {
  const DcMotorParameters parameters;
  DcMotor motor(parameters, {});
  DcMotorState state = motor.at(0.0);
  state.speed = 50.0;
  for (int n = 0; n < 50'000; ++n) {
    motor.step(state, {.open = true}, 20e-6);
  }
  EXPECT_EQ(state.speed, 0.0);
  EXPECT_EQ(state.current, 0.0);
}

TEST(DcMotor, CoastsDownAsItsEquationSays) {
  DcMotorParameters parameters;
  parameters.static_friction = parameters.coulomb_friction;
  DcMotor motor(parameters, {});
  DcMotorState state = motor.at(0.0);
  state.speed = 300.0;
  double time = 0.0;
  for (int n = 0; n < 10'000; ++n, time += 20e-6) {
    motor.step(state, {.open = true}, 20e-6);
  }
  const double b = parameters.viscous_friction;
  const double ratio = parameters.coulomb_friction / b;
  const double expected = (300.0 + ratio) * std::exp(-b * time / parameters.rotor_inertia) - ratio;
  EXPECT_NEAR(state.speed, expected, 1e-6);
}

}  // namespace
}  // namespace stator::plant
