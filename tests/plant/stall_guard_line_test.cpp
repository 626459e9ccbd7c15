// The load measurement of a driver chip on the simulated motor: what StallGuard2 shows over load,
// speed and current.

#include <cmath>

#include <gtest/gtest.h>

#include "plant/rotating_field.hpp"
#include "stator/control/stepper/stall_guard.hpp"

namespace stator::plant {
namespace {

class StallGuardLine : public testing::Test {
 protected:
  static StepperAxisParameters parameters(double supply = 48.0) {
    StepperAxisParameters parameters;
    parameters.motor = *find_stepper_motor("QSH5718-55-30-098");
    parameters.motor.viscous_friction = 5e-3;  // keeps resonances out of it
    parameters.supply_voltage = supply;
    return parameters;
  }
  /// An axis that turns with `revolutions` per second under `load` (N m), then mean and spread of
  /// its measurements.
  double measure(double revolutions, double amplitude, double load, double supply = 48.0) {
    StepperAxis axis(parameters(supply));
    RotatingField field(axis, amplitude);
    field.run(0.5, revolutions * base::kTwoPi / 0.5);
    for (int n = 1; n <= 100; ++n) {
      axis.set_external_torque(-load * n / 100.0);
      field.run(0.01);
    }
    field.run(0.3);
    control::StallGuard chip;
    double sum = 0.0;
    int count = 0;
    lowest_ = 1e9;
    highest_ = -1e9;
    for (int n = 0; n < 10'000; ++n) {
      field.step();
      if (chip.advance({.threshold = 0, .filter = true}, field.actuation().coil_current_target,
                       true, field.sensing())) {
        sum += chip.value();
        lowest_ = std::fmin(lowest_, chip.value());
        highest_ = std::fmax(highest_, chip.value());
        ++count;
      }
    }
    return sum / count;
  }
  static double pull_out(double revolutions, double amplitude) {
    StepperAxis axis(parameters());
    RotatingField field(axis, amplitude);
    field.run(0.5, revolutions * base::kTwoPi / 0.5);
    field.run(0.5);
    return field.pull_out(0.05);
  }

  double lowest_ = 0.0;
  double highest_ = 0.0;
};

TEST_F(StallGuardLine, FallsLinearlyFromNoLoadToZeroAtPullOut) {
  for (const double revolutions : {2.0, 4.0}) {
    const double amplitude = 3.0;
    const double limit = pull_out(revolutions, amplitude);
    const double unloaded = measure(revolutions, amplitude, 0.0);
    ASSERT_GT(unloaded, 200.0);
    for (const double share : {0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 0.95}) {
      const double line = unloaded * (1.0 - share);
      EXPECT_NEAR(measure(revolutions, amplitude, share * limit), line, 0.02 * unloaded)
          << revolutions << " rev/s, " << share << " of " << limit << " N m; " << lowest_ << ".."
          << highest_;
    }
  }
}

TEST_F(StallGuardLine, GrowsWithSpeedWhileTheCurrentIsRegulatedAndCollapsesAboveThat) {
  const StepperMotorParameters motor = parameters().motor;
  for (const double revolutions : {1.0, 2.0, 4.0}) {
    const double speed = revolutions * base::kTwoPi;
    const double friction = motor.viscous_friction * speed + motor.coulomb_friction;
    const double unused = (motor.pole_pairs * motor.flux_linkage - friction / 3.0) * speed;
    const double expected = control::StallGuard::kCountsPerVolt * unused;
    EXPECT_NEAR(measure(revolutions, 3.0, 0.0), expected, 0.02 * expected) << revolutions;
  }
  const double regulated = measure(4.0, 3.0, 0.0, 12.0);
  EXPECT_LT(measure(6.0, 3.0, 0.0, 12.0), 0.5 * regulated) << "12 V do not suffice";
}

TEST_F(StallGuardLine, TheSameLoadIsASmallerPartOfMoreCurrent) {
  const double weak = measure(2.0, 2.0, 0.3);
  const double strong = measure(2.0, 4.0, 0.3);
  EXPECT_GT(strong, 1.4 * weak);
}

TEST_F(StallGuardLine, ABlockedShaftReadsZero) {
  StepperAxisParameters blocked = parameters();
  blocked.load.end_stop_maximum = 1.0;
  StepperAxis axis(blocked);
  RotatingField field(axis, 3.0);
  control::StallGuard chip;
  field.run(0.25, 2.0 * base::kTwoPi / 0.25);
  int zeros = 0;
  int count = 0;
  for (int n = 0; n < 20'000; ++n) {
    field.step();
    if (chip.advance({.threshold = 0, .filter = true}, field.actuation().coil_current_target, true,
                     field.sensing()) &&
        n > 10'000) {
      zeros += chip.value() == 0 ? 1 : 0;
      ++count;
    }
  }
  EXPECT_EQ(zeros, count);
  EXPECT_GT(count, 40);
}

}  // namespace
}  // namespace stator::plant
