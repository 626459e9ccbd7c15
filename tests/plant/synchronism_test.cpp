#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "plant/rotating_field.hpp"

// Torque against load angle, pull-out and loss of synchronism: nothing of it is scripted in the
// model, so these tests compare it with the textbook's formulas.

namespace stator::plant {
namespace {

using namespace base::literals;

constexpr double kSquareRootOfTwo = 1.41421356237309504880;

StepperAxisParameters damped_axis() {
  StepperAxisParameters parameters;
  parameters.motor = *find_stepper_motor("QSH5718-55-30-098");
  parameters.motor.coulomb_friction = 0.0;
  parameters.motor.static_friction = 0.0;
  parameters.motor.viscous_friction = 0.01;
  parameters.supply_voltage = 48.0;
  return parameters;
}

double rated_amplitude(const StepperAxisParameters& parameters) {
  return kSquareRootOfTwo * parameters.motor.rated_current;
}

/// Electrical angle by which `torque` deflects a rotor with holding torque `th` and detent `td`:
/// th sin(x) + td sin(4 x) = torque.
double static_deflection(double torque, double th, double td) {
  double low = 0.0;
  double high = 0.5 * base::kPi;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (th * std::sin(middle) + td * std::sin(4.0 * middle) < torque ? low : high) = middle;
  }
  return low;
}

TEST(Synchronism, StaticLoadAngleIsTheArcSineCorrectedByDetentTorque) {
  for (const double torque : {0.1, 0.3, 0.6, 0.8}) {
    const StepperAxisParameters parameters = damped_axis();
    StepperAxis axis(parameters);
    RotatingField field(axis, rated_amplitude(parameters));
    for (int n = 0; n < 20'000; ++n) {
      axis.set_external_torque(-torque * std::min(1.0, n / 10'000.0));
      field.step();
    }
    const double expected = static_deflection(torque, parameters.motor.holding_torque(),
                                              parameters.motor.detent_torque);
    EXPECT_NEAR(field.lag(), expected, 1e-6) << torque << " N m";
    EXPECT_NEAR(axis.observe().load_angle, expected, 1e-6) << torque << " N m";
    EXPECT_NEAR(axis.observe().electromagnetic_torque,
                parameters.motor.holding_torque() * std::sin(expected), 1e-6);
  }
}

TEST(Synchronism, HoldingTorqueIsWhatTheSheetSays) {
  StepperAxisParameters parameters = damped_axis();
  parameters.motor.detent_torque = 0.0;
  StepperAxis axis(parameters);
  RotatingField field(axis, rated_amplitude(parameters));
  const double torque = field.pull_out(0.1);
  EXPECT_NEAR(torque, parameters.motor.holding_torque(), 0.01 * parameters.motor.holding_torque());
}

TEST(Synchronism, PullOutAtLowSpeedIsTheHoldingTorque) {
  for (const StepperMotorSheet& sheet : stepper_motor_sheets()) {
    StepperAxisParameters parameters;
    parameters.motor = parameters_of(sheet);
    parameters.motor.detent_torque = 0.0;  // its ripple shakes the rotor: pull-out comes earlier
    parameters.supply_voltage = 48.0;
    StepperAxis axis(parameters);
    RotatingField field(axis, rated_amplitude(parameters));
    const double speed = base::kTwoPi;  // 1 rev/s
    field.run(0.5, speed / 0.5);
    field.run(0.5);
    const double friction =
        parameters.motor.coulomb_friction + parameters.motor.viscous_friction * speed;
    const double torque = field.pull_out(0.2 * sheet.holding_torque) + friction;
    EXPECT_NEAR(torque, sheet.holding_torque, 0.02 * sheet.holding_torque) << sheet.name;
  }
}

TEST(Synchronism, SupplyLimitedPullOutFollowsTheVoltageFormula) {
  // The formula is for a circular voltage limit; each phase clipped on its own yields up to 4/pi
  // (the fundamental of a square wave) of the voltage. The measured value must lie between.
  struct Case {
    double supply;
    double revolutions_per_second;
  };
  for (const Case& c : {Case{24.0, 10.0}, Case{24.0, 15.0}, Case{48.0, 20.0}, Case{48.0, 22.0}}) {
    StepperAxisParameters parameters = damped_axis();
    parameters.motor.viscous_friction = 5e-3;  // enough to keep mid-band instability out of it
    parameters.supply_voltage = c.supply;
    StepperAxis axis(parameters);
    RotatingField field(axis, rated_amplitude(parameters));
    const double speed = c.revolutions_per_second * base::kTwoPi;
    field.run(1.0, speed);
    field.run(0.5);
    ASSERT_LT(field.lag(), base::kPi) << "lost steps while accelerating";
    const double torque = field.pull_out(0.1) + parameters.motor.viscous_friction * speed;

    const StepperMotorParameters& motor = parameters.motor;
    const double kt = motor.pole_pairs * motor.flux_linkage;
    const double impedance =
        std::hypot(motor.resistance, motor.pole_pairs * speed * motor.inductance);
    const double braking = kt * kt * speed * motor.resistance / (impedance * impedance);
    const double circular = kt * c.supply / impedance - braking;
    const double square = kt * c.supply * 4.0 / base::kPi / impedance - braking;
    EXPECT_GT(torque, circular) << c.supply << " V, " << c.revolutions_per_second << " rev/s";
    EXPECT_LT(torque, square) << c.supply << " V, " << c.revolutions_per_second << " rev/s";
    EXPECT_LT(torque, motor.holding_torque());
  }
}

TEST(Synchronism, OverloadLosesStepsInMultiplesOfFourFullSteps) {
  for (const double milliseconds : {20.0, 35.0, 50.0, 80.0, 120.0}) {
    StepperAxisParameters parameters;
    parameters.motor = *find_stepper_motor("QSH5718-55-30-098");
    parameters.load.inertia = 1e-4;
    parameters.load.viscous_friction = 0.01;
    parameters.supply_voltage = 48.0;
    StepperAxis axis(parameters);
    RotatingField field(axis, rated_amplitude(parameters));
    field.run(0.5, 2.0 * base::kTwoPi);
    axis.set_external_torque(-2.0 * parameters.motor.holding_torque());
    field.run(milliseconds * 1e-3);
    axis.set_external_torque(0.0);
    field.run(0.5);
    field.run(0.5, -2.0 * base::kTwoPi);
    field.stop();
    field.run(0.5);
    const double lost_full_steps = field.lag() / (0.5 * base::kPi);
    const double periods = std::round(lost_full_steps / 4.0);
    EXPECT_GE(periods, 1.0) << milliseconds << " ms";
    EXPECT_NEAR(lost_full_steps, 4.0 * periods, 0.02) << milliseconds << " ms";
  }
}

TEST(Synchronism, LoadBelowPullOutLosesNothing) {
  StepperAxisParameters parameters;
  parameters.motor = *find_stepper_motor("QSH5718-55-30-098");
  StepperAxis axis(parameters);
  RotatingField field(axis, rated_amplitude(parameters));
  axis.set_external_torque(-0.5 * parameters.motor.holding_torque());
  field.run(0.5, 2.0 * base::kTwoPi);
  field.run(2.0);
  EXPECT_LT(std::fabs(field.lag()), 0.5 * base::kPi);
}

TEST(Synchronism, StartingAboveThePullInSpeedStalls) {
  StepperAxisParameters parameters;
  parameters.motor = *find_stepper_motor("QSH5718-55-30-098");
  StepperAxis axis(parameters);
  RotatingField field(axis, rated_amplitude(parameters));
  field.run(RotatingField::kStep.seconds(), 20.0 * base::kTwoPi / RotatingField::kStep.seconds());
  field.run(1.0);  // the field turns at 20 rev/s from the first step on
  EXPECT_LT(axis.observe().shaft_revolutions, 5.0);
  EXPECT_GT(field.lag(), 100.0);
}

}  // namespace
}  // namespace stator::plant
