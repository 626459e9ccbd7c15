// The TMCC160's servo controller in each commutation mode: angles, initialisation, sensors,
// positions.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "control/servo_motor_model.hpp"
#include "stator/control/servo/servo_controller.hpp"

namespace stator::control {
namespace {

ServoControllerSettings with(ServoCommutation commutation) {
  ServoControllerSettings settings;
  settings.commutation = commutation;
  return settings;
}

/// Signed difference of an angle object and electrical turns, in degrees.
double degrees_off(std::int16_t object, double turns) {
  const double off = object / 65536.0 - turns;
  return (off - std::round(off)) * 360.0;
}

class ServoModes : public testing::TestWithParam<ServoCommutation> {};

TEST_P(ServoModes, TurnTheMotorBothWays) {
  ServoMotorModel::Parameters motor;
  motor.angle = 0.3;
  motor.friction = 3e-3;
  ServoBench bench(with(GetParam()), motor);
  bench.set_point.loop = ServoLoop::velocity;
  for (const double target : {800.0, -800.0}) {
    double ramp = bench.set_point.velocity;
    while (ramp != target) {
      ramp = target > ramp ? std::min(target, ramp + 2.0) : std::max(target, ramp - 2.0);
      bench.set_point.velocity = ramp;
      bench.run(0.001);
    }
    bench.run(1.0);
    EXPECT_NEAR(bench.motor.rpm(), target, 12.0);
    EXPECT_NEAR(bench.controller.velocity(), target, 12.0);
    EXPECT_FALSE(bench.controller.hall_error());
    EXPECT_FALSE(bench.controller.motor_halted());
    const std::int64_t before = bench.controller.position();
    const double angle = bench.motor.angle();
    bench.run(1.0);
    const double increments =
        (bench.motor.angle() - angle) / (2.0 * M_PI) * bench.controller.increments_per_revolution();
    EXPECT_NEAR(static_cast<double>(bench.controller.position() - before), increments,
                0.001 * std::fabs(increments) + 1.5);
  }
  bench.set_point.loop = ServoLoop::off;
  bench.run(1.0);
  EXPECT_FALSE(bench.actuation.bridge_enabled);
  EXPECT_EQ(bench.controller.velocity(), 0.0);
  EXPECT_TRUE(bench.controller.motor_halted());
}

TEST_P(ServoModes, MoveToAPosition) {
  ServoBench bench(with(GetParam()));
  const int revolution = bench.controller.increments_per_revolution();
  bench.set_point.loop = ServoLoop::position;
  for (int k = 0; k < 40'000; ++k) {  // three revolutions in two seconds
    bench.set_point.position = displaced({0, 0.0}, 3.0 * revolution * k / 40'000.0);
    bench.step();
  }
  bench.set_point.position = {std::int64_t{3} * revolution, 0.0};
  bench.run(1.0);
  EXPECT_NEAR(bench.motor.angle(), 6.0 * M_PI, 2.0 * M_PI * 1.0 / 24.0);
  EXPECT_NEAR(static_cast<double>(bench.controller.position()), 3.0 * revolution, 1.0);
}

INSTANTIATE_TEST_SUITE_P(AllModes, ServoModes,
                         testing::Values(ServoCommutation::hall, ServoCommutation::encoder,
                                         ServoCommutation::controlled));

TEST(HallServo, PositionCountsSixStepsToAnElectricalTurn) {
  ServoBench bench(with(ServoCommutation::hall));
  EXPECT_EQ(bench.controller.increments_per_revolution(), 24);
  bench.step();
  for (int k = 0; k < 1000; ++k) {
    bench.motor.set_angle(2.0 * M_PI * k / 1000.0);
    bench.step();
  }
  EXPECT_EQ(bench.controller.position(), 24);
}

TEST(HallServo, InterpolationKeepsTheFluxCurrentSmall) {
  const auto flux = [](bool interpolated) {
    ServoControllerSettings settings = with(ServoCommutation::hall);
    settings.hall_interpolated = interpolated;
    ServoMotorModel::Parameters motor;
    motor.friction = 3e-3;
    ServoBench bench(settings, motor);
    bench.set_point.loop = ServoLoop::velocity;
    bench.set_point.velocity = 1000.0;
    bench.run(2.0);
    double worst = 0.0;
    for (int k = 0; k < 2000; ++k) {
      bench.step();
      worst = std::max(worst, std::fabs(bench.motor.id()));
    }
    return worst;
  };
  EXPECT_LT(flux(true), 0.15);
  EXPECT_GT(flux(false), 0.4);
}

TEST(HallServo, InvertedSignalsNeedTheInversion) {
  ServoControllerSettings settings = with(ServoCommutation::hall);
  settings.hall_inverted = true;
  ServoBench bench(settings);
  bench.set_point.loop = ServoLoop::torque;
  bench.set_point.torque = 0.5;
  for (int k = 0; k < 200; ++k) {
    bench.motor.sensing().halls ^= 7U;
    bench.step();
  }
  EXPECT_GT(bench.motor.rpm(), 100.0);
  EXPECT_FALSE(bench.controller.hall_error());
}

TEST(HallServo, ASwappedPairDoesNotTurnTheMotorAndAnInvertedLineIsAnError) {
  ServoBench swapped(with(ServoCommutation::hall));
  swapped.motor.halls_swapped = true;
  swapped.motor.set_angle(0.0);
  swapped.set_point.loop = ServoLoop::velocity;
  swapped.set_point.velocity = 500.0;
  swapped.run(2.0);
  EXPECT_LT(std::fabs(swapped.motor.angle()), 2.0 * M_PI);
  EXPECT_FALSE(swapped.controller.hall_error()) << "each code is possible";

  ServoBench inverted(with(ServoCommutation::hall));
  inverted.motor.hall_inverted = true;
  for (int k = 0; k < 100; ++k) {
    inverted.motor.set_angle(0.01 * k);
    inverted.step();
  }
  EXPECT_TRUE(inverted.controller.hall_error());
}

TEST(HallServo, ErrorsOfHallsThatAreNotUsedDoNotCount) {
  ServoBench bench(with(ServoCommutation::controlled));
  bench.motor.sensing().halls = 0;
  bench.step();
  EXPECT_FALSE(bench.controller.hall_error());
  ServoControllerSettings by_hall = with(ServoCommutation::hall);
  bench.controller.configure(by_hall);
  bench.motor.sensing().halls = 0;
  bench.step();
  EXPECT_TRUE(bench.controller.hall_error());
}

TEST(EncoderServo, AlignModeFindsTheAngleFromAnywhere) {
  for (const double angle : {0.0, 0.2, 0.5, M_PI / 4.0, 1.2, 1.5, -0.4}) {  // pi / 4: dead point
    ServoControllerSettings settings = with(ServoCommutation::encoder);
    settings.init_mode = EncoderInitMode::align;
    ServoMotorModel::Parameters motor;
    motor.angle = angle;
    motor.friction = 2e-3;
    ServoBench bench(settings, motor);
    bench.set_point.loop = ServoLoop::torque;
    bench.run(0.5);
    EXPECT_TRUE(bench.controller.initialising());
    EXPECT_NEAR(bench.motor.id(), 1.5, 0.1);
    bench.run(0.6);
    EXPECT_TRUE(bench.controller.initialised()) << angle;
    EXPECT_NEAR(degrees_off(bench.controller.encoder_angle(), bench.motor.electrical_turns()), 0.0,
                4.0)
        << angle;
    bench.set_point.torque = 1.0;
    bench.run(0.02);
    EXPECT_GT(bench.motor.rpm(), 100.0);
  }
}

TEST(EncoderServo, HallModeIsExactAfterTheFirstEdge) {
  ServoMotorModel::Parameters motor;
  motor.angle = 0.1;
  ServoBench bench(with(ServoCommutation::encoder), motor);
  bench.set_point.loop = ServoLoop::velocity;
  bench.step();
  EXPECT_TRUE(bench.controller.initialised());
  EXPECT_LE(
      std::fabs(degrees_off(bench.controller.encoder_angle(), bench.motor.electrical_turns())),
      30.0);
  bench.set_point.velocity = 60.0;
  bench.run(0.5);
  EXPECT_NEAR(degrees_off(bench.controller.encoder_angle(), bench.motor.electrical_turns()), 0.0,
              1.5);
}

TEST(EncoderServo, IndexModeTurnsToTheNPulseAndUsesTheOffset) {
  ServoControllerSettings settings = with(ServoCommutation::encoder);
  settings.init_mode = EncoderInitMode::index;
  settings.encoder_offset = 637;  // the pulse at 1 rad, in steps
  for (const int velocity : {100, -100}) {
    settings.init_velocity = velocity;
    ServoMotorModel::Parameters motor;
    motor.angle = 0.3;
    motor.friction = 2e-3;
    ServoBench bench(settings, motor);
    bench.set_point.loop = ServoLoop::velocity;
    double longest = 0.0;
    while (!bench.controller.initialised() && longest < 3.0) {
      bench.step();
      longest += 50e-6;
    }
    EXPECT_LT(longest, 0.7) << velocity;
    EXPECT_NEAR(degrees_off(bench.controller.encoder_angle(), bench.motor.electrical_turns()), 0.0,
                1.0)
        << velocity;
    EXPECT_EQ(bench.controller.encoder_offset(), 637);
  }
}

TEST(EncoderServo, AFailedInitialisationKeepsTheBridgeOffUntilTheNextAttempt) {
  ServoBench bench(with(ServoCommutation::encoder));
  bench.motor.sensing().halls = 0;
  bench.set_point.loop = ServoLoop::velocity;
  bench.actuation = bench.controller.step(bench.set_point, bench.motor.sensing());
  EXPECT_TRUE(bench.controller.init_error());
  EXPECT_FALSE(bench.actuation.bridge_enabled);
  bench.set_point.loop = ServoLoop::off;
  bench.run(0.001);
  EXPECT_TRUE(bench.controller.init_error());
  bench.set_point.loop = ServoLoop::velocity;  // the halls are back
  bench.run(0.001);
  EXPECT_FALSE(bench.controller.init_error());
  EXPECT_TRUE(bench.actuation.bridge_enabled);
}

TEST(EncoderServo, IsInitialisedOnceOnly) {
  ServoBench bench(with(ServoCommutation::encoder));
  bench.set_point.loop = ServoLoop::velocity;
  bench.run(0.01);
  bench.set_point.loop = ServoLoop::off;
  bench.run(0.01);
  bench.motor.sensing().halls = 0;  // would fail
  bench.set_point.loop = ServoLoop::velocity;
  bench.actuation = bench.controller.step(bench.set_point, bench.motor.sensing());
  EXPECT_FALSE(bench.controller.init_error());
  bench.controller.forget_initialisation();
  EXPECT_FALSE(bench.controller.initialised());
}

TEST(EncoderServo, AnOffsetErrorCostsTorqueByItsCosine) {
  const auto torque = [](int offset) {
    ServoControllerSettings settings = with(ServoCommutation::encoder);
    ServoMotorModel::Parameters motor;
    motor.inertia = 0.0;
    ServoBench bench(settings, motor);
    bench.set_point.loop = ServoLoop::torque;
    bench.run(0.001);  // initialised by halls at angle 0: right
    settings.encoder_offset = static_cast<std::uint16_t>((offset + 4000) % 4000);
    settings.encoder_offset = settings.encoder_offset == 0 ? 4000 : settings.encoder_offset;
    bench.controller.configure(settings);
    bench.set_point.torque = 2.0;
    bench.run(0.2);
    return bench.motor.torque_constant() * bench.motor.iq();
  };
  const double full = torque(0);
  EXPECT_NEAR(full, 0.072, 0.001);
  for (const int offset : {100, -100, 200, 250, 400}) {
    EXPECT_NEAR(torque(offset), full * std::cos(2.0 * M_PI * offset / 1000.0), 0.01 * full)
        << offset;
  }
}

TEST(EncoderServo, TheAngleIsAdvancedByTheDelayOfTheLoop) {
  ServoBench bench(with(ServoCommutation::encoder));
  bench.set_point.loop = ServoLoop::velocity;
  bench.set_point.velocity = 3500.0;
  bench.run(1.5);
  // Without it the voltage would lag by 6.3 degrees: 0.96 V of 8.8 V on the d axis, which the flux
  // integrator would have to hold. What is left is the coupling of the axes, and half of a degree.
  const double omega = bench.motor.rpm() * M_PI / 30.0 * 4.0;
  const double coupling = -1000.0 * omega * bench.motor.parameters().inductance * bench.motor.iq();
  EXPECT_NEAR(bench.controller.flux_error_sum() * 500.0 / 65536.0, coupling, 120.0);
}

TEST(ControlledServo, ImposesAnAngleWithTheOpenLoopCurrent) {
  ServoControllerSettings settings = with(ServoCommutation::controlled);
  settings.open_loop_current = 1200;
  ServoBench bench(settings);
  bench.set_point.loop = ServoLoop::velocity;
  bench.set_point.velocity = 60.0;
  bench.run(1.0);
  EXPECT_NEAR(bench.controller.actual_current(), 1200, 20);
  EXPECT_EQ(bench.controller.target_current(), 1200);
  EXPECT_NEAR(std::hypot(bench.motor.id(), bench.motor.iq()), 1.2, 0.03);
  const std::int16_t before = bench.controller.open_loop_angle();
  bench.run(0.025);  // 1 rev/s and 4 pole pairs: a tenth of an electrical turn
  EXPECT_NEAR(static_cast<std::int16_t>(bench.controller.open_loop_angle() - before), 6554, 20);
}

TEST(ControlledServo, AnglesOfFieldHallsAndEncoderAgreeWhenTheShaftRunsFree) {
  ServoControllerSettings settings = with(ServoCommutation::controlled);
  ServoBench bench(settings);
  bench.set_point.loop = ServoLoop::velocity;
  bench.set_point.velocity = 60.0;
  bench.run(2.0);
  for (int k = 0; k < 1000; ++k) {
    bench.step();
    const double turns = bench.motor.electrical_turns();
    ASSERT_NEAR(degrees_off(bench.controller.open_loop_angle(), turns), 0.0, 8.0);
    ASSERT_NEAR(degrees_off(bench.controller.hall_angle(), turns), 0.0, 31.0);
    ASSERT_NEAR(degrees_off(bench.controller.encoder_angle(), turns), 0.0, 1.0);
  }
}

TEST(ServoController, AnotherCommutationModeSetsThePositionToZero) {
  ServoBench bench(with(ServoCommutation::encoder));
  for (int k = 0; k < 100; ++k) {
    bench.motor.set_angle(0.01 * k);
    bench.step();
  }
  EXPECT_GT(bench.controller.position(), 500);
  bench.controller.configure(with(ServoCommutation::hall));
  EXPECT_EQ(bench.controller.position(), 0);
  EXPECT_EQ(bench.controller.increments_per_revolution(), 24);
  bench.controller.configure(with(ServoCommutation::encoder));
  EXPECT_EQ(bench.controller.position(), 0);
  bench.controller.set_position(-123'456'789'012);
  EXPECT_EQ(bench.controller.position(), -123'456'789'012);
}

TEST(EncoderServo, TheEncodersDirectionTurnsThePosition) {
  ServoControllerSettings settings = with(ServoCommutation::encoder);
  settings.encoder_reversed = true;
  ServoBench bench(settings);
  bench.step();
  bench.motor.set_angle(M_PI);
  bench.step();
  EXPECT_EQ(bench.controller.position(), -2000);
}

TEST(ServoController, SwitchedOffItDoesNotDriveAndShowsNoCurrents) {
  ServoBench bench(with(ServoCommutation::encoder));
  bench.set_point.loop = ServoLoop::velocity;
  bench.set_point.velocity = 1000.0;
  bench.run(0.01);
  bench.set_point.loop = ServoLoop::off;
  bench.step();
  EXPECT_FALSE(bench.actuation.bridge_enabled);
  EXPECT_EQ(bench.controller.actual_current(), 0);
  EXPECT_EQ(bench.controller.target_current(), 0);
  EXPECT_EQ(bench.controller.torque_error_sum(), 0);
  EXPECT_EQ(bench.controller.velocity_error_sum(), 0);
}

TEST(ServoController, DrivesTheBrakeChopperInEveryState) {
  ServoControllerSettings settings = with(ServoCommutation::hall);
  settings.brake_chopper_enabled = true;
  ServoBench bench(settings);
  bench.motor.parameters().supply = 26.2;
  bench.run(0.0001);
  EXPECT_TRUE(bench.actuation.brake_chopper_on);
  EXPECT_TRUE(bench.controller.brake_chopper_on());
  bench.motor.parameters().supply = 25.6;
  bench.run(0.0001);
  EXPECT_TRUE(bench.actuation.brake_chopper_on);
  bench.motor.parameters().supply = 25.4;
  bench.run(0.0001);
  EXPECT_FALSE(bench.actuation.brake_chopper_on);
}

TEST(ServoController, ChangingFromTorqueToVelocityKeepsTheTorque) {
  ServoBench bench(with(ServoCommutation::encoder));
  bench.motor.set_load(0.036);
  bench.set_point.loop = ServoLoop::torque;
  bench.set_point.torque = 1.0;
  bench.run(0.3);
  bench.set_point.loop = ServoLoop::velocity;
  bench.set_point.velocity = bench.controller.velocity();
  bench.run(0.002);
  EXPECT_NEAR(bench.controller.target_current(), 1000, 100);
}

TEST(ServoController, ACopyGoesOnAsTheOriginalDoes) {
  ServoBench bench(with(ServoCommutation::hall));
  bench.set_point.loop = ServoLoop::velocity;
  bench.set_point.velocity = 700.0;
  bench.run(0.1);
  ServoBench copy = bench;
  for (int k = 0; k < 2000; ++k) {
    bench.step();
    copy.step();
    ASSERT_EQ(bench.actuation, copy.actuation);
  }
}

}  // namespace
}  // namespace stator::control
