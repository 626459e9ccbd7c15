// Torque and velocity limits of the TMCC160's servo controller, and what its sensors show in and
// out of rest.
#include <array>
#include <cstddef>
#include <cstdint>

#include <gtest/gtest.h>

#include "control/servo_motor_model.hpp"
#include "stator/control/servo/servo_controller.hpp"

namespace stator::control {
namespace {

constexpr std::array<std::uint8_t, 6> kCodes = {0b001, 0b011, 0b010, 0b110, 0b100, 0b101};

ServoControllerSettings with(ServoCommutation commutation) {
  ServoControllerSettings settings;
  settings.commutation = commutation;
  return settings;
}

ServoMotorModel::Parameters locked() {
  ServoMotorModel::Parameters motor;
  motor.inertia = 0.0;
  return motor;
}

ServoSetPoint torque_of(double torque) {
  ServoSetPoint set_point;
  set_point.loop = ServoLoop::torque;
  set_point.torque = torque;
  return set_point;
}

ServoSetPoint velocity_of(double velocity) {
  ServoSetPoint set_point;
  set_point.loop = ServoLoop::velocity;
  set_point.velocity = velocity;
  return set_point;
}

TEST(ServoLimits, TorqueFarFromTheVelocityLimitIsBoundedByTheTorqueLimit) {
  ServoBench bench({}, locked());
  for (const double torque : {9.0, -9.0}) {
    bench.set_point = torque_of(torque);
    bench.run(0.005);
    EXPECT_EQ(bench.controller.target_current(), torque > 0.0 ? 9000 : -9000);
    EXPECT_EQ(bench.controller.ramp_target_current(), torque > 0.0 ? 4000 : -4000);
  }
}

TEST(ServoLimits, BrakingAMotorThatIsMuchTooFastUsesTheTorqueLimitAtMost) {
  for (const int direction : {1, -1}) {
    ServoControllerSettings settings = with(ServoCommutation::encoder);
    settings.maximum_velocity = 1000;
    ServoController controller;
    controller.configure(settings);
    base::ServoSensing sensing;
    sensing.halls = 1;
    sensing.supply_voltage = 24.0;
    for (int k = 0; k < 400; ++k) {
      sensing.encoder_count += 5 * direction;  // 1500 rpm
      controller.step(torque_of(direction), sensing);
    }
    EXPECT_NEAR(controller.measured_velocity(), 1500.0 * direction, 1e-6);
    EXPECT_EQ(controller.ramp_target_current(), -4000 * direction);
  }
}

TEST(ServoLimits, ATorqueActsInTheSamePeriod) {
  ServoBench bench({}, locked());
  bench.set_point = torque_of(1.0);
  bench.step();
  for (int k = 1; k < 50; ++k) {
    bench.set_point.torque = 1.0 + 0.01 * k;
    bench.step();
    ASSERT_EQ(bench.controller.target_current(), 1000 + 10 * k);
  }
}

TEST(ServoLimits, TheVelocityLoopsSumHoldsNoMoreThanTheTorqueLimit) {
  // u * I * sum / 65536 is a current; what goes beyond the limit would have to be unwound later.
  for (const ServoCommutation commutation : {ServoCommutation::hall, ServoCommutation::encoder}) {
    ServoControllerSettings settings = with(commutation);
    settings.velocity_p = 0;
    ServoBench bench(settings, locked());
    bench.set_point = velocity_of(1000.0);
    bench.run(3.0);
    const double current = outer_gain_unit(commutation) * settings.velocity_i *
                           static_cast<double>(bench.controller.velocity_error_sum()) / 65536.0;
    EXPECT_NEAR(current, 4000.0, 8.0);
    EXPECT_EQ(bench.controller.target_current(), bench.controller.ramp_target_current());
  }
}

TEST(ServoLimits, NoSumIsLeftWhenTheLoopIsOpened) {
  ServoControllerSettings settings;
  settings.velocity_i = 1;  // the sum that stands for an output is largest then
  ServoBench bench(settings, locked());
  bench.set_point = velocity_of(1000.0);
  bench.run(0.01);
  EXPECT_GT(bench.controller.velocity_error_sum(), 0);
  bench.set_point = {};
  bench.run(0.01);
  EXPECT_EQ(bench.controller.velocity_error_sum(), 0);
  bench.set_point = torque_of(1.0);
  bench.run(0.01);
  EXPECT_EQ(bench.controller.velocity_error_sum(), 0) << "nor is one there when it is closed";
}

TEST(ServoVelocity, IsTheMeasuredOneSmoothedWith4Milliseconds) {
  ServoController controller;
  controller.configure(with(ServoCommutation::encoder));
  base::ServoSensing sensing;
  sensing.halls = 1;
  controller.step({}, sensing);
  double expected = controller.velocity();
  for (int millisecond = 0; millisecond < 40; ++millisecond) {
    for (int k = 0; k < ServoController::kOuterLoopDivider; ++k) {
      sensing.encoder_count += millisecond < 20 ? 3 : 0;
      controller.step({}, sensing);
    }
    expected += 0.25 * (controller.measured_velocity() - expected);
    ASSERT_NEAR(controller.velocity(), expected, 2e-3) << millisecond;
  }
}

TEST(ServoVelocity, AnotherSensorIsNoMovement) {
  ServoController controller;
  base::ServoSensing sensing;
  sensing.halls = 1;
  sensing.encoder_count = 100'000;
  for (int k = 0; k < 45; ++k) {
    controller.step({}, sensing);
  }
  controller.configure(with(ServoCommutation::encoder));
  for (int k = 0; k < 45; ++k) {
    controller.step({}, sensing);
    ASSERT_EQ(controller.measured_velocity(), 0.0) << k;
  }
}

/// Turns by halls with `periods` per sixth; how far the angle moves within the last sixth.
int way_within_a_sixth(int periods) {
  ServoControllerSettings settings;
  settings.hall_interpolated = true;
  ServoController controller;
  controller.configure(settings);
  base::ServoSensing sensing;
  int way = 0;
  for (std::size_t sixth = 0; sixth < 4; ++sixth) {
    sensing.halls = kCodes[sixth];
    controller.step({}, sensing);
    const int at_the_edge = controller.hall_angle();
    for (int k = 2; k < periods; ++k) {
      controller.step({}, sensing);
    }
    way = static_cast<std::int16_t>(controller.hall_angle() - at_the_edge);
    controller.step({}, sensing);
  }
  return way;
}

TEST(ServoHalls, AreInterpolatedAbove60RpmOnly) {
  // 4 pole pairs: 24 sixths per revolution, 833 periods of 50 us each at 60 rpm.
  EXPECT_GT(way_within_a_sixth(100), 9'000);
  EXPECT_GT(way_within_a_sixth(800), 9'000);
  EXPECT_EQ(way_within_a_sixth(860), 0);
  EXPECT_EQ(way_within_a_sixth(3'000), 0);
}

TEST(ServoRest, IsAsGoodAsThatManySteps) {
  for (const int periods : {1, 19, 20, 21, 47, 400}) {
    ServoControllerSettings settings;
    settings.hall_interpolated = true;
    ServoController stepped;
    stepped.configure(settings);
    base::ServoSensing sensing;
    for (int k = 0; k < 1'005; ++k) {
      sensing.halls = kCodes[static_cast<std::size_t>(k / 100) % kCodes.size()];
      stepped.step({}, sensing);
    }
    ServoController rested = stepped;
    for (int k = 0; k < periods; ++k) {
      stepped.step({}, sensing);
    }
    rested.rest(periods, sensing);
    EXPECT_EQ(rested.hall_angle(), stepped.hall_angle()) << periods;
    EXPECT_EQ(rested.velocity(), stepped.velocity()) << periods;
    EXPECT_EQ(rested.measured_velocity(), stepped.measured_velocity()) << periods;
    for (int k = 0; k < 45; ++k) {
      stepped.step({}, sensing);
      rested.step({}, sensing);
      ASSERT_EQ(rested.velocity(), stepped.velocity()) << periods << ", " << k;
    }
  }
}

/// Aligns for 20 ms with `current` amperes in phase U all the time, half of it back in V and W.
ServoController aligned_with(double current) {
  ServoControllerSettings settings = with(ServoCommutation::encoder);
  settings.init_mode = EncoderInitMode::align;
  settings.init_delay = 20;
  settings.open_loop_current = 1500;
  ServoController controller;
  controller.configure(settings);
  base::ServoSensing sensing;
  sensing.halls = 1;
  sensing.supply_voltage = 24.0;
  sensing.phase_current = {current, -0.5 * current, -0.5 * current};
  for (int k = 0; k < 30 * ServoController::kOuterLoopDivider; ++k) {
    controller.step(velocity_of(0.0), sensing);
  }
  return controller;
}

TEST(EncoderServoAlignment, NeedsHalfOfItsCurrent) {
  // With less, nothing has drawn the rotor to angle 0: a phase is open or the supply is missing.
  EXPECT_TRUE(aligned_with(0.6).init_error());
  EXPECT_TRUE(aligned_with(0.749).init_error());
  EXPECT_TRUE(aligned_with(0.75).initialised());
}

TEST(EncoderServoAlignment, ShowsNoCurrentAfterItHasFailed) {
  const ServoController controller = aligned_with(0.6);
  EXPECT_EQ(controller.actual_current(), 0) << "the bridge is off";
  EXPECT_EQ(controller.target_current(), 0);
  EXPECT_EQ(controller.ramp_target_current(), 0);
}

}  // namespace
}  // namespace stator::control
