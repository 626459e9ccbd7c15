// The TMCC160's servo controller on a motor as a drive: wiring errors, initialisations, I2t, brake
// chopper.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "stator/base/trigonometry.hpp"
#include "stator/control/servo/servo_controller.hpp"
#include "stator/plant/axes/servo_axis.hpp"
#include "stator/plant/motors/three_phase_motor.hpp"

namespace stator {
namespace {

using namespace base::literals;

plant::ServoAxisParameters default_axis() {
  plant::ServoAxisParameters parameters;
  parameters.motor = *plant::find_three_phase_motor("QBL4208-61-04-013");
  parameters.load.inertia = 5e-6;
  parameters.encoder.counts_per_revolution = 4000;
  parameters.initial_revolutions = 0.03;
  return parameters;
}

control::ServoControllerSettings with(control::ServoCommutation commutation) {
  control::ServoControllerSettings settings;
  settings.commutation = commutation;
  return settings;
}

/// The controller of a drive on the plant of a motor.
class Drive {
 public:
  explicit Drive(const control::ServoControllerSettings& settings,
                 const plant::ServoAxisParameters& parameters = default_axis())
      : plant(parameters) {
    controller.configure(settings);
  }
  void step() {
    actuation = controller.step(set_point, plant.sensing());
    plant.step(actuation, control::ServoController::kPeriod);
  }
  void run(double seconds) {
    for (auto left = static_cast<int>(seconds * 20'000.0 + 0.5); left > 0; --left) {
      step();
    }
  }
  /// Turns at `rpm`, coming from the present velocity with 2000 rpm/s.
  void ramp_to(double rpm) {
    set_point.loop = control::ServoLoop::velocity;
    while (set_point.velocity != rpm) {
      constexpr double kStep = 0.1;  // rpm per period
      const double left = rpm - set_point.velocity;
      set_point.velocity += std::clamp(left, -kStep, kStep);
      step();
    }
  }
  [[nodiscard]] double rpm() const { return plant.observe().speed * 30.0 / base::kPi; }
  [[nodiscard]] double angle_error_degrees() const {
    const double off =
        controller.encoder_angle() / 65536.0 - plant.observe().electrical_angle / base::kTwoPi;
    return (off - std::round(off)) * 360.0;
  }

  plant::ServoAxis plant;
  control::ServoController controller;
  control::ServoSetPoint set_point;
  base::ServoActuation actuation;
};

class ServoDrive : public testing::TestWithParam<control::ServoCommutation> {};

TEST_P(ServoDrive, TurnsTheMotorBothWays) {
  Drive drive(with(GetParam()));
  for (const double rpm : {1000.0, -1000.0, 3000.0}) {
    drive.ramp_to(rpm);
    drive.run(1.0);
    EXPECT_NEAR(drive.rpm(), rpm, 0.02 * std::fabs(rpm));
    EXPECT_NEAR(drive.controller.velocity(), rpm, 0.02 * std::fabs(rpm));
  }
  EXPECT_FALSE(drive.controller.hall_error());
}

INSTANTIATE_TEST_SUITE_P(AllModes, ServoDrive,
                         testing::Values(control::ServoCommutation::hall,
                                         control::ServoCommutation::encoder,
                                         control::ServoCommutation::controlled));

TEST(ServoDrivePlant, AVelocityStepIsWellDampedWithTheDefaultGains) {
  for (const double load : {0.0, 5e-6, 2e-5}) {
    plant::ServoAxisParameters parameters = default_axis();
    parameters.load.inertia = load;
    Drive drive(with(control::ServoCommutation::encoder), parameters);
    drive.set_point.loop = control::ServoLoop::velocity;
    drive.set_point.velocity = 1000.0;
    double highest = 0.0;
    for (int k = 0; k < 20'000; ++k) {
      drive.step();
      highest = std::max(highest, drive.rpm());
    }
    EXPECT_LT(highest, 1100.0) << load;
    EXPECT_NEAR(drive.rpm(), 1000.0, 20.0) << load;
  }
}

TEST(ServoDrivePlant, SwappedHallWiresKeepTheMotorFromTurning) {
  Drive drive(with(control::ServoCommutation::hall));
  plant::ServoAxisFaults faults;
  faults.halls_swapped = true;
  drive.plant.set_faults(faults);
  drive.ramp_to(500.0);
  drive.run(1.0);
  EXPECT_LT(std::fabs(drive.plant.observe().shaft_revolutions), 1.0);
  EXPECT_GT(drive.controller.velocity_error(), 250);
}

TEST(ServoDrivePlant, AStuckHallLineIsAHallError) {
  Drive drive(with(control::ServoCommutation::hall));
  drive.ramp_to(200.0);
  EXPECT_FALSE(drive.controller.hall_error());
  plant::ServoAxisFaults faults;
  faults.halls[1] = plant::HallFault::stuck_low;
  drive.plant.set_faults(faults);
  drive.run(0.5);
  EXPECT_TRUE(drive.controller.hall_error());
}

TEST(ServoDrivePlant, AnOffsetErrorOfTheEncoderCostsTorqueByItsCosine) {
  const auto torque = [](int steps) {
    plant::ServoAxisParameters parameters = default_axis();
    parameters.load.inertia = 1.0;  // stands still
    parameters.initial_revolutions = 0.0;
    parameters.motor.cogging = {};
    Drive drive(with(control::ServoCommutation::encoder), parameters);
    drive.set_point.loop = control::ServoLoop::torque;
    drive.run(0.001);
    control::ServoControllerSettings settings = drive.controller.settings();
    settings.encoder_offset = static_cast<std::uint16_t>(steps);
    drive.controller.configure(settings);
    drive.set_point.torque = 2.0;
    drive.run(0.2);
    return drive.plant.observe().electromagnetic_torque;
  };
  // 1000 encoder steps to the electrical turn of the default motor.
  const double full = torque(4000);
  EXPECT_NEAR(full, 2.0 * default_axis().motor.torque_constant(), 0.01 * full);
  for (const int steps : {83, 167, 250, 333}) {
    EXPECT_NEAR(torque(steps), full * std::cos(base::kTwoPi * steps / 1000.0), 0.01 * full)
        << steps;
  }
}

TEST(ServoDrivePlant, EveryInitialisationOfTheEncoderFindsTheRotor) {
  for (const control::EncoderInitMode mode :
       {control::EncoderInitMode::align, control::EncoderInitMode::hall,
        control::EncoderInitMode::index}) {
    plant::ServoAxisParameters parameters = default_axis();
    parameters.initial_revolutions = 0.17;
    control::ServoControllerSettings settings = with(control::ServoCommutation::encoder);
    settings.init_mode = mode;
    Drive drive(settings, parameters);
    drive.set_point.loop = control::ServoLoop::velocity;
    for (int k = 0; k < 40'000 && !drive.controller.initialised(); ++k) {
      drive.step();
    }
    ASSERT_TRUE(drive.controller.initialised()) << static_cast<int>(mode);
    drive.ramp_to(100.0);
    drive.run(0.5);
    EXPECT_NEAR(drive.angle_error_degrees(), 0.0, 8.0) << static_cast<int>(mode);
    EXPECT_NEAR(drive.rpm(), 100.0, 25.0) << static_cast<int>(mode);  // cogging
  }
}

TEST(ServoDrivePlant, AlignmentFailsWithABrokenCableAndIndexSearchWithoutAnNPulse) {
  plant::ServoAxisFaults faults;
  faults.open = {true, true, true};
  faults.common.encoders[0].index_lost = true;
  for (const control::EncoderInitMode mode :
       {control::EncoderInitMode::align, control::EncoderInitMode::index}) {
    control::ServoControllerSettings settings = with(control::ServoCommutation::encoder);
    settings.init_mode = mode;
    Drive drive(settings);
    drive.plant.set_faults(faults);
    drive.set_point.loop = control::ServoLoop::velocity;
    drive.run(2.0);
    EXPECT_TRUE(drive.controller.init_error()) << static_cast<int>(mode);
    EXPECT_FALSE(drive.actuation.bridge_enabled);
    EXPECT_EQ(drive.controller.target_current(), 0);
  }
}

TEST(ServoDrivePlant, I2tTripsAfterTheTimeOfItsExponentialAndTheMotorCoastsDown) {
  control::ServoControllerSettings settings = with(control::ServoCommutation::encoder);
  settings.i2t_time_constant = 2000;
  settings.i2t_limit = 2 * 2 * 2000;  // 2 A for ever
  plant::ServoAxisParameters parameters = default_axis();
  parameters.load.viscous_friction = 1e-3;
  Drive drive(settings, parameters);
  drive.set_point.loop = control::ServoLoop::torque;
  drive.set_point.torque = 4.0;
  double time = 0.0;
  while (!drive.controller.i2t_exceeded() && time < 5.0) {
    drive.step();
    time += 50e-6;
  }
  EXPECT_NEAR(time, -2.0 * std::log(1.0 - 4.0 / 16.0), 0.03);
  EXPECT_GT(drive.rpm(), 500.0);
  drive.run(0.5);
  EXPECT_NEAR(drive.plant.observe().quadrature_current, 0.0, 0.05);
  EXPECT_LT(drive.rpm(), 20.0);
}

TEST(ServoDrivePlant, TheBrakeChopperHoldsTheSupplyWhenAFlywheelIsBraked) {
  const auto highest_voltage = [](bool chopper) {
    control::ServoControllerSettings settings = with(control::ServoCommutation::encoder);
    settings.brake_chopper_enabled = chopper;
    plant::ServoAxisParameters parameters = default_axis();
    parameters.load.inertia = 5e-5;
    Drive drive(settings, parameters);
    drive.ramp_to(3000.0);
    drive.set_point.velocity = 0.0;  // at once
    double highest = 0.0;
    for (int k = 0; k < 10'000; ++k) {
      drive.step();
      highest = std::max(highest, drive.plant.observe().supply_voltage);
    }
    return highest;
  };
  EXPECT_GT(highest_voltage(false), 28.0);
  EXPECT_LT(highest_voltage(true), 26.5);
}

TEST(ServoDrivePlant, APositionMoveEndsWithinTheReachedWindow) {
  Drive drive(with(control::ServoCommutation::encoder));
  drive.set_point.loop = control::ServoLoop::position;
  for (int k = 0; k < 20'000; ++k) {  // smoothly from 0 to 20000 steps in a second
    const double phase = k / 20'000.0;
    const double share = phase - base::sine_cosine(base::kTwoPi * phase).sine / base::kTwoPi;
    drive.set_point.position = control::displaced({0, 0.0}, 20'000.0 * share);
    drive.set_point.velocity =
        300.0 * (1.0 - base::sine_cosine(base::kTwoPi * phase).cosine);  // 5 revolutions in 1 s
    drive.step();
  }
  drive.set_point.position = {20'000, 0.0};
  drive.set_point.velocity = 0.0;
  drive.run(2.0);
  EXPECT_NEAR(static_cast<double>(drive.controller.position()), 20'000.0, 5.0);
  EXPECT_TRUE(drive.controller.motor_halted());
}

}  // namespace
}  // namespace stator
