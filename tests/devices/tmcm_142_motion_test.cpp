// Motion of the TMCM-142: what commands and axis parameters do to the motor.

#include <cmath>

#include <gtest/gtest.h>

#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "tmcm_142_module.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;
using tmcl::Command;
using tmcl::Status;
using enum devices::tmcm_142::AxisParameter;

/// With parameter 27 at 1: 1024 microsteps per full step, 200 full steps.
constexpr double kMicrosteps = 204'800.0;
constexpr int kVelocity = 2;

struct Tmcm142Motion : testing::Test {
  Tmcm142Module module;
  [[nodiscard]] double revolutions() { return module.signal("axis0.shaft_position"); }
};

TEST_F(Tmcm142Motion, PositioningTurnsTheShaft) {
  EXPECT_EQ(module.sap(unit_conversion_mode, 1), Status::success);
  EXPECT_EQ(module.sap(max_positioning_speed, 400'000), Status::success);
  EXPECT_EQ(module.sap(max_acceleration_and_deceleration, 2'000'000), Status::success);
  EXPECT_EQ(module.execute(Command::move_to_position, 0, 0, 409'600).status, Status::success);
  EXPECT_EQ(module.gap(ramp_mode), 0);
  EXPECT_EQ(module.gap(target_position), 409'600);
  ASSERT_TRUE(module.run_to_target(3_s));
  module.run(300_ms);
  EXPECT_EQ(module.gap(actual_position), 409'600);
  EXPECT_NEAR(revolutions(), 2.0, 1e-4);
}

TEST_F(Tmcm142Motion, RotationHasItsSignAndUnit) {
  ASSERT_EQ(module.sap(unit_conversion_mode, 1), Status::success);
  ASSERT_EQ(module.sap(max_acceleration_and_deceleration, 5'000'000), Status::success);
  ASSERT_EQ(module.execute(Command::rotate_left, 0, 0, 204'800).status, Status::success);
  EXPECT_EQ(module.gap(ramp_mode), kVelocity);
  EXPECT_EQ(module.gap(target_speed), -204'800);
  module.run(1_s);
  EXPECT_EQ(module.gap(actual_speed), -204'800);
  EXPECT_EQ(module.gap(velocity_reached), 1);
  const double before = revolutions();
  module.run(1_s);
  EXPECT_NEAR(revolutions() - before, -1.0, 0.005);
  ASSERT_EQ(module.execute(Command::motor_stop, 0, 0).status, Status::success);
  module.run(500_ms);
  EXPECT_EQ(module.gap(actual_speed), 0);
  EXPECT_EQ(module.gap(status_flags) & 4, 4);
}

TEST_F(Tmcm142Motion, VelocitiesAreLimitedInPulsesPerSecondToo) {
  EXPECT_EQ(module.execute(Command::rotate_right, 0, 0, 2'147'483'647).status, Status::success);
  EXPECT_EQ(module.gap(target_speed), 2'147'483'647);
  EXPECT_EQ(module.sap(unit_conversion_mode, 1), Status::success);
  EXPECT_EQ(module.gap(target_speed), 31'999'999);
  EXPECT_EQ(module.execute(Command::rotate_right, 0, 0, 31'999'999).status, Status::success);
  EXPECT_EQ(module.execute(Command::rotate_right, 0, 0, 32'000'000).status, Status::invalid_value);
  EXPECT_EQ(module.execute(Command::rotate_left, 0, 0, 32'000'000).status, Status::invalid_value);
}

TEST_F(Tmcm142Motion, VelocitiesAndAccelerationsConvertAndNothingElse) {
  ASSERT_EQ(module.sap(max_acceleration, 1'000), Status::success);
  ASSERT_EQ(module.sap(max_positioning_speed, 1'000'000), Status::success);
  ASSERT_EQ(module.sap(encoder_constant, 12'345), Status::success);
  ASSERT_EQ(module.sap(unit_conversion_mode, 1), Status::success);
  EXPECT_EQ(module.gap(max_acceleration), 58'208);       // * 16e6^2 / (16 * 256) / 2^30
  EXPECT_EQ(module.gap(max_positioning_speed), 14'901);  // * 2 * 16e6 / 2^31
  EXPECT_EQ(module.gap(encoder_constant), 12'345);
  ASSERT_EQ(module.sap(reference_search_speed, 14'901), Status::success);
  ASSERT_EQ(module.sap(unit_conversion_mode, 0), Status::success);
  EXPECT_NEAR(module.gap(reference_search_speed), 1'000'000, 34);
  ASSERT_EQ(module.sap(unit_conversion_mode, 1), Status::success);
  EXPECT_EQ(module.sap(stop_deceleration, 1), Status::success) << "the chip's smallest one";
  EXPECT_EQ(module.gap(stop_deceleration), 58);
  EXPECT_EQ(module.sap(stop_deceleration, 976'562'442), Status::invalid_value);
  EXPECT_EQ(module.sap(stop_deceleration, 976'562'441), Status::success);
}

TEST_F(Tmcm142Motion, OneParameterSetsBothAccelerations) {
  ASSERT_EQ(module.sap(max_acceleration_and_deceleration, 7'000), Status::success);
  EXPECT_EQ(module.gap(max_acceleration), 7'000);
  EXPECT_EQ(module.gap(max_deceleration), 7'000);
  ASSERT_EQ(module.sap(max_acceleration, 8'000), Status::success);
  EXPECT_EQ(module.gap(max_acceleration_and_deceleration), 8'000);
  EXPECT_EQ(module.gap(max_deceleration), 7'000);
}

TEST_F(Tmcm142Motion, TargetAndSpeedChangeOnTheFly) {
  ASSERT_EQ(module.sap(unit_conversion_mode, 1), Status::success);
  ASSERT_EQ(module.sap(max_positioning_speed, 200'000), Status::success);
  ASSERT_EQ(module.sap(max_acceleration_and_deceleration, 2'000'000), Status::success);
  ASSERT_EQ(module.execute(Command::move_to_position, 0, 0, 1'000'000).status, Status::success);
  module.run(1_s);
  EXPECT_EQ(module.gap(actual_speed), 200'000);
  ASSERT_EQ(module.sap(max_positioning_speed, 100'000), Status::success);
  module.run(500_ms);
  EXPECT_EQ(module.gap(actual_speed), 100'000);
  ASSERT_EQ(module.sap(target_position, 0), Status::success);
  ASSERT_TRUE(module.run_to_target(10_s));
  EXPECT_EQ(module.gap(actual_position), 0);
}

TEST(Tmcm142Latches, AreReadAndClearedByTheirParameters) {
  Tmcm142Configuration configuration;
  configuration.axis.encoder.index_position = 10'000;
  Tmcm142Module module(configuration);
  ASSERT_EQ(module.sap(unit_conversion_mode, 1), Status::success);
  ASSERT_EQ(module.sap(max_acceleration_and_deceleration, 2'000'000), Status::success);
  ASSERT_EQ(module.sap(encoder_mode, 1 << 2 | 1 << 3 | 1 << 6), Status::success);
  ASSERT_EQ(module.sap(switch_mode, 1 << 10), Status::success);
  EXPECT_EQ(module.gap(encoder_status), 0);
  ASSERT_EQ(module.execute(Command::rotate_right, 0, 0, 102'400).status, Status::success);
  module.run(800_ms);
  EXPECT_NEAR(module.gap(encoder_latch), 10'000, 1);
  EXPECT_EQ(module.gap(encoder_status), 1);
  EXPECT_EQ(module.gap(encoder_status), 0) << "cleared by reading";
  const std::int32_t before = module.gap(actual_position);
  module.set("axis0.right_switch", 1.0);
  module.run(1_ms);
  EXPECT_NEAR(module.gap(position_latch), before, 15);
  EXPECT_EQ(module.gap(switch_status) & 0xC, 0x8) << "latch event of the right switch";
  EXPECT_EQ(module.gap(switch_status) & 0xC, 0) << "cleared by reading";
}

TEST(Tmcm142Inertia, AHardStopAtSpeedLosesSteps) {
  Tmcm142Configuration configuration;
  configuration.axis.load.inertia = 2e-4;
  Tmcm142Module module(configuration);
  ASSERT_EQ(module.sap(unit_conversion_mode, 1), Status::success);
  ASSERT_EQ(module.sap(max_acceleration_and_deceleration, 4'000'000), Status::success);
  ASSERT_EQ(module.execute(Command::rotate_right, 0, 0, 2'048'000).status, Status::success);
  module.run(2_s);
  ASSERT_NEAR(module.signal("axis0.shaft_speed"), 10.0, 0.1);
  ASSERT_EQ(module.sap(max_deceleration, 976'562'441), Status::success);
  ASSERT_EQ(module.execute(Command::motor_stop, 0, 0).status, Status::success);
  module.run(1_s);
  const double lost =
      module.signal("axis0.shaft_position") - module.gap(actual_position) / kMicrosteps;
  EXPECT_GT(std::fabs(lost), 0.019) << "four full steps at least";
  EXPECT_NEAR(std::remainder(lost, 0.02), 0.0, 2e-3) << "whole periods";
}

TEST_F(Tmcm142Motion, ShaftReversesTheMotorAndNotThePosition) {
  ASSERT_EQ(module.sap(shaft, 1), Status::success);
  ASSERT_EQ(module.execute(Command::move_to_position, 0, 0, 20'480).status, Status::success);
  ASSERT_TRUE(module.run_to_target(5_s));
  module.run(300_ms);
  EXPECT_EQ(module.gap(actual_position), 20'480);
  EXPECT_NEAR(module.signal("axis0.shaft_position"), -0.1, 1e-4);
}

TEST_F(Tmcm142Motion, CurrentsAreSixteenStepsOfSevenAmperes) {
  ASSERT_EQ(module.sap(max_current, 15), Status::success);
  ASSERT_EQ(module.sap(standby_current, 3), Status::success);
  ASSERT_EQ(module.sap(standby_delay, 10), Status::success);
  const auto amperes = [&] {
    return std::hypot(module.signal("axis0.coil_current_a"), module.signal("axis0.coil_current_b"));
  };
  module.run(30_ms);
  EXPECT_NEAR(amperes(), 7.0, 0.02) << "10 * 4.096 ms are not over";
  module.run(20_ms);
  EXPECT_NEAR(amperes(), 7.0 * 3 / 15, 0.02);
}

TEST_F(Tmcm142Motion, ModesByHand) {
  EXPECT_EQ(module.sap(ramp_mode, 1), Status::invalid_value);
  EXPECT_EQ(module.sap(ramp_mode, 4), Status::invalid_value);
  ASSERT_EQ(module.execute(Command::rotate_right, 0, 0, 1'000'000).status, Status::success);
  module.run(1_s);
  EXPECT_EQ(module.sap(ramp_mode, 3), Status::success);
  const std::int32_t held = module.gap(actual_speed);
  ASSERT_EQ(module.sap(max_acceleration, 1'000'000), Status::success);
  module.run(100_ms);
  EXPECT_EQ(module.gap(actual_speed), held);
  EXPECT_EQ(module.gap(ramp_mode), 3);
  EXPECT_EQ(module.sap(ramp_mode, 2), Status::success);
  EXPECT_EQ(module.sap(actual_speed, 5), Status::success) << "accepted without effect";
}

TEST_F(Tmcm142Motion, TheTablePositionIsSetAtStandstillOnly) {
  EXPECT_EQ(module.sap(microstep_table_position, 4'096), Status::success);
  EXPECT_EQ(module.gap(microstep_table_position), 4'096);
  ASSERT_EQ(module.execute(Command::rotate_right, 0, 0, 1'000'000).status, Status::success);
  module.run(100_ms);
  EXPECT_EQ(module.sap(microstep_table_position, 0), Status::invalid_value);
}

TEST_F(Tmcm142Motion, TheActualPositionCanBeNamed) {
  ASSERT_EQ(module.execute(Command::rotate_right, 0, 0, 0).status, Status::success);
  EXPECT_EQ(module.sap(actual_position, -500), Status::success);
  module.run(100_ms);
  EXPECT_EQ(module.gap(actual_position), -500);
  EXPECT_EQ(module.gap(target_position), 0);
  EXPECT_EQ(module.gap(position_reached), 0) << "a plain comparison in every mode";
}

TEST_F(Tmcm142Motion, AComparePositionIsTold) {
  EXPECT_EQ(module.sap(compare_position, 10'000), Status::success);
  EXPECT_EQ(module.gap(compare_position), 10'000);
  ASSERT_EQ(module.execute(Command::move_to_position, 0, 0, 20'000).status, Status::success);
  ASSERT_TRUE(module.run_to_target(5_s));
  EXPECT_EQ(module.events.count("position 10000"), 1);
}

TEST_F(Tmcm142Motion, StepAndFullStepOutputsPulse) {
  SerialCable cable;
  ASSERT_EQ(module.sap(step_pulse_length, 16), Status::success);
  ASSERT_EQ(module.execute(Command::move_to_position, 0, 0, 20'480).status, Status::success);
  ASSERT_TRUE(module.run_to_target(5_s));
  module.run(10_ms);
  EXPECT_EQ(module.signal("axis0.step_pulses"), 20'480.0);
  EXPECT_EQ(module.signal("axis0.full_step_pulses"), 20.0);
  ASSERT_TRUE(module.device->connect_serial("rs232", &cable));
  ASSERT_EQ(module.execute(Command::move_to_position, 0, 0, 0).status, Status::success);
  ASSERT_TRUE(module.run_to_target(5_s));
  EXPECT_EQ(module.signal("axis0.step_pulses"), 20'480.0) << "RS-232 takes the pins";
}

TEST_F(Tmcm142Motion, EncoderDeviationStopsTheMotor) {
  ASSERT_EQ(module.sap(unit_conversion_mode, 1), Status::success);
  ASSERT_EQ(module.sap(encoder_constant, 335'544), Status::success);  // 5.12 microsteps
  ASSERT_EQ(module.sap(maximum_encoder_deviation, 10'000), Status::success);
  ASSERT_EQ(module.execute(Command::rotate_right, 0, 0, 102'400).status, Status::success);
  module.run(1_s);
  EXPECT_NEAR(module.gap(encoder_position), module.gap(actual_position), 400);
  module.set("axis0.load_torque", -5.0);
  module.run(1_s);
  EXPECT_EQ(module.gap(actual_speed), 0);
  EXPECT_EQ(module.gap(error_flags), 2);
  EXPECT_EQ(module.gap(error_flags), 0) << "cleared by reading";
  EXPECT_TRUE(module.raised(tmcl::ErrorFlag::deviation));
  EXPECT_EQ(module.events.count("motor stopped at"), 1);
}

}  // namespace
}  // namespace stator::tests
