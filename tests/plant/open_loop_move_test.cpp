#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "stator/control/ramp/ramp_generator.hpp"
#include "stator/control/stepper/microstep_sequencer.hpp"
#include "stator/plant/axes/stepper_axis.hpp"

// Ramp, sequencer and plant wired as a device wires them.

namespace stator::plant {
namespace {

using namespace base::literals;

constexpr double kMicrostepsPerRevolution = 51'200.0;

struct Outcome {
  double final_error = 0.0;  ///< microsteps, shaft minus demand, at rest
  double peak_lag = 0.0;     ///< microsteps
  std::int64_t encoder_count = 0;
};

Outcome move(const StepperAxisParameters& parameters, std::int64_t target,
             const control::RampLimits& limits) {
  StepperAxis axis(parameters);
  control::RampGenerator ramp;
  const control::MicrostepSequencer sequencer;
  Outcome outcome;
  const auto tick = [&] {
    ramp.advance(50_us);
    base::AxisActuation actuation;
    actuation.bridge_enabled = true;
    actuation.coil_current_target = sequencer.coil_currents(ramp.motor_microsteps(), 3.0);
    outcome.encoder_count = axis.step(actuation, 50_us).encoder_count;
    const double demand = control::distance({0, 0.0}, ramp.position());
    outcome.final_error = axis.observe().shaft_revolutions * kMicrostepsPerRevolution - demand;
    outcome.peak_lag = std::max(outcome.peak_lag, std::fabs(outcome.final_error));
  };
  ramp.move_to(target, limits);
  while (!ramp.at_rest()) {
    tick();
  }
  for (int n = 0; n < 10'000; ++n) {  // half a second to settle
    tick();
  }
  return outcome;
}

TEST(OpenLoopMove, TenRevolutionsEndWithinOneMicrostepForEveryNamedMotor) {
  for (const StepperMotorSheet& sheet : stepper_motor_sheets()) {
    StepperAxisParameters parameters;
    parameters.motor = parameters_of(sheet);
    parameters.load.inertia = parameters.motor.rotor_inertia;
    const Outcome outcome =
        move(parameters, 512'000,
             {.velocity = 150'000.0, .acceleration = 300'000.0, .deceleration = 500'000.0});
    EXPECT_LE(std::fabs(outcome.final_error), 1.0) << sheet.name;
    EXPECT_LT(outcome.peak_lag, 256.0) << sheet.name << " was close to losing steps";
    EXPECT_NEAR(static_cast<double>(outcome.encoder_count), 400'000.0, 1.0) << sheet.name;
  }
}

TEST(OpenLoopMove, LoadOfTwiceTheHoldingTorqueLosesSteps) {
  StepperAxisParameters parameters;
  parameters.motor = *find_stepper_motor("QSH5718-55-30-098");
  parameters.load.coulomb_friction = 2.0 * parameters.motor.holding_torque();
  const Outcome outcome =
      move(parameters, 512'000,
           {.velocity = 150'000.0, .acceleration = 300'000.0, .deceleration = 500'000.0});
  EXPECT_NEAR(outcome.final_error, -512'000.0, 256.0);
}

}  // namespace
}  // namespace stator::plant
