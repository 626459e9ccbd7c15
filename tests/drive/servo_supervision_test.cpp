// What a servo axis watches, its status flags (bit_fields.csv, 200Dh) and its statusword bits.

#include <array>
#include <cstdint>
#include <cstdlib>

#include <gtest/gtest.h>

#include "drive/servo_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;
using enum PowerState;

class ServoSupervision : public testing::Test {
 protected:
  void enable() { bench_.enable(ModeCode::profile_position); }
  void expect_fault(AxisError error) {
    EXPECT_TRUE(bench_.axis->errors().has(error));
    EXPECT_TRUE(bench_.pass_until([&] { return bench_.axis->power_state() == fault; }, 2_s));
  }
  void reset_fault() {
    bench_.write(0x6040, 0);
    bench_.write(0x6040, 0x80);
    EXPECT_EQ(bench_.axis->power_state(), switch_on_disabled);
  }
  ServoBench bench_;
};

TEST_F(ServoSupervision, TooLowASupplyIsAFaultAndTakesBitFourAway) {
  enable();
  EXPECT_TRUE(bench_.status(statusword::kVoltageEnabled));
  bench_.sensing.supply_voltage = 6.9;
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.flag(ServoFlag::undervoltage));
  EXPECT_FALSE(bench_.status(statusword::kVoltageEnabled));
  expect_fault(AxisError::undervoltage);
  bench_.sensing.supply_voltage = 24.0;
  bench_.pass(2_ms);
  EXPECT_FALSE(bench_.flag(ServoFlag::undervoltage)) << "the flag follows its condition";
  reset_fault();
}

TEST_F(ServoSupervision, TooHighASupplyIsAFault) {
  enable();
  bench_.sensing.supply_voltage = 28.1;
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.flag(ServoFlag::overvoltage));
  EXPECT_FALSE(bench_.status(statusword::kVoltageEnabled));
  expect_fault(AxisError::overvoltage);
}

TEST_F(ServoSupervision, ATurningMotorCoastsWhenTheSupplyIsTooHighForBrakingFeedsItFurther) {
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, 1000);
  bench_.pass(1_s);
  ASSERT_GT(bench_.rpm(), 900.0);
  bench_.sensing.supply_voltage = 28.1;
  bench_.pass(2_ms);
  EXPECT_EQ(bench_.axis->power_state(), fault) << "no ramp first";
  EXPECT_FALSE(bench_.actuation.bridge_enabled);
  bench_.pass(50_ms);
  EXPECT_GT(bench_.rpm(), 800.0) << "friction alone";
}

TEST_F(ServoSupervision, ATooHighSupplyHasToFallByTheHysteresis) {
  bench_.sensing.supply_voltage = 28.1;
  bench_.pass(2_ms);
  ASSERT_TRUE(bench_.flag(ServoFlag::overvoltage));
  bench_.sensing.supply_voltage = 27.7;
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.flag(ServoFlag::overvoltage)) << "0.5 V below 28 V";
  bench_.sensing.supply_voltage = 27.4;
  bench_.pass(2_ms);
  EXPECT_FALSE(bench_.flag(ServoFlag::overvoltage));
}

TEST_F(ServoSupervision, AWarmDriverWarnsAHotOneSwitchesOffAtOnce) {
  enable();
  bench_.sensing.driver_temperature = 101.0;
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.axis->errors().has(AxisError::over_temperature_warning));
  EXPECT_TRUE(bench_.status(statusword::kWarning));
  EXPECT_FALSE(bench_.flag(ServoFlag::overtemperature));
  EXPECT_EQ(bench_.axis->power_state(), operation_enabled);
  bench_.sensing.driver_temperature = 121.0;
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.flag(ServoFlag::overtemperature));
  EXPECT_FALSE(bench_.actuation.bridge_enabled);
  expect_fault(AxisError::over_temperature);
}

TEST_F(ServoSupervision, AShortSwitchesThePhasesOffInTheSamePeriod) {
  const std::array errors{AxisError::overcurrent_a, AxisError::overcurrent_b,
                          AxisError::overcurrent_c};
  for (std::size_t phase = 0; phase < errors.size(); ++phase) {
    ServoBench bench;
    bench.enable(ModeCode::profile_position);
    bench.sensing.overcurrent[phase] = true;
    bench.pass(50_us);
    EXPECT_FALSE(bench.actuation.bridge_enabled);
    bench.sensing.overcurrent[phase] = false;
    bench.pass(2_ms);
    EXPECT_TRUE(bench.flag(ServoFlag::overcurrent));
    EXPECT_TRUE(bench.axis->errors().has(errors[phase]));
    EXPECT_TRUE(bench.pass_until([&] { return bench.axis->power_state() == fault; }, 1_s));
    bench.write(0x6040, 0x80);
    EXPECT_EQ(bench.axis->power_state(), switch_on_disabled);
    bench.pass(2_ms);
    EXPECT_FALSE(bench.flag(ServoFlag::overcurrent));
  }
}

TEST_F(ServoSupervision, AShortOnTheHighSideIsOneOfTheDriver) {
  enable();
  bench_.sensing.overcurrent_high_side = true;
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.flag(ServoFlag::driver_error));
  expect_fault(AxisError::overcurrent_high_side);
}

TEST_F(ServoSupervision, ImpossibleHallsAreAFaultWithHallCommutationOnly) {
  ServoBench by_encoder;
  by_encoder.enable(ModeCode::profile_position);
  EXPECT_FALSE(by_encoder.axis->errors().has(AxisError::hall_error));

  bench_.axis->servo_settings().controller.commutation = control::ServoCommutation::hall;
  bench_.pass(5_ms);
  enable();
  EXPECT_FALSE(bench_.flag(ServoFlag::hall_error));
  bench_.axis->servo_settings().controller.hall_inverted = false;
  base::ServoSensing broken = bench_.sensing;
  broken.halls = 0b111;
  static_cast<void>(bench_.axis->step(broken));
  bench_.axis->tick(bench_.now);
  EXPECT_TRUE(bench_.flag(ServoFlag::hall_error));
  expect_fault(AxisError::hall_error);
  bench_.pass(2_ms);
  EXPECT_FALSE(bench_.flag(ServoFlag::hall_error));
}

TEST_F(ServoSupervision, AFailedInitialisationIsAFaultThatMayBeTriedAgain) {
  bench_.axis->servo_settings().controller.init_mode = control::EncoderInitMode::index;
  bench_.axis->servo_settings().controller.init_velocity = 0;
  bench_.pass(2_ms);
  EXPECT_FALSE(bench_.flag(ServoFlag::module_initialised));
  bench_.enable(ModeCode::profile_position);
  bench_.pass(5_ms);
  EXPECT_TRUE(bench_.flag(ServoFlag::init_error));
  expect_fault(AxisError::initialisation_error);
  bench_.axis->servo_settings().controller.init_mode = control::EncoderInitMode::hall;
  bench_.pass(2_ms);
  reset_fault();
  bench_.pass(2_ms);
  EXPECT_FALSE(bench_.flag(ServoFlag::init_error));
  enable();
  EXPECT_EQ(bench_.axis->power_state(), operation_enabled);
  EXPECT_TRUE(bench_.flag(ServoFlag::module_initialised));
}

TEST_F(ServoSupervision, SetPointsWaitForTheInitialisation) {
  bench_.set_profile(1000, 10'000, 10'000);
  bench_.axis->servo_settings().controller.init_mode = control::EncoderInitMode::align;
  bench_.axis->servo_settings().controller.init_delay = 500;
  bench_.pass(2_ms);
  bench_.enable(ModeCode::profile_position);
  bench_.write(0x607A, 8000);
  bench_.start();
  bench_.pass(300_ms);
  EXPECT_FALSE(bench_.flag(ServoFlag::module_initialised));
  EXPECT_TRUE(bench_.status(statusword::kSetPointAcknowledge));
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
  EXPECT_LT(std::abs(bench_.motor.counts()), 1100.0) << "it only aligns";
  EXPECT_TRUE(bench_.pass_until(
      [&] {
        return bench_.status(statusword::kTargetReached) &&
               std::llabs(bench_.position() - 8000) <= 5;
      },
      5_s));
  EXPECT_TRUE(bench_.flag(ServoFlag::module_initialised));
}

TEST_F(ServoSupervision, AMissingEnableSignalSwitchesAnEnabledDriveOff) {
  bench_.axis->conditions().shutdown_switch = true;
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.flag(ServoFlag::emergency_stop));
  EXPECT_EQ(bench_.axis->power_state(), switch_on_disabled) << "nothing to switch off";
  bench_.axis->conditions().shutdown_switch = false;
  enable();
  bench_.axis->conditions().shutdown_switch = true;
  bench_.pass(2_ms);
  EXPECT_FALSE(bench_.actuation.bridge_enabled);
  expect_fault(AxisError::shutdown_switch);
  bench_.write(0x6040, 0x80);
  EXPECT_EQ(bench_.axis->power_state(), fault) << "still missing";
  bench_.axis->conditions().shutdown_switch = false;
  bench_.pass(2_ms);
  EXPECT_FALSE(bench_.flag(ServoFlag::emergency_stop));
  reset_fault();
}

TEST_F(ServoSupervision, TooMuchI2tForcesTheCurrentToZeroAndIsNoFault) {
  bench_.motor.blocked = true;
  bench_.axis->servo_settings().controller.i2t_time_constant = 1000;
  bench_.axis->servo_settings().controller.i2t_limit = 500;
  bench_.pass(2_ms);
  bench_.enable(ModeCode::cyclic_synchronous_torque);
  bench_.write(0x6071, 2000);
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.flag(ServoFlag::it_exceeded); }, 3_s));
  EXPECT_TRUE(bench_.axis->errors().has(AxisError::overload));
  bench_.pass(200_ms);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x6077)), 0.0, 30.0);
  EXPECT_EQ(bench_.axis->power_state(), operation_enabled);
  bench_.pass(5_s);
  EXPECT_TRUE(bench_.flag(ServoFlag::it_exceeded)) << "until it is cleared";
  bench_.write(0x6071, 0);
  bench_.axis->clear_i2t_exceeded();
  bench_.pass(2_ms);
  EXPECT_FALSE(bench_.flag(ServoFlag::it_exceeded));
}

TEST_F(ServoSupervision, FlagsNameTheLoopAndWhetherTheMotorIsFree) {
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.flag(ServoFlag::stop_mode));
  EXPECT_TRUE(bench_.flag(ServoFlag::free_running));
  EXPECT_FALSE(bench_.flag(ServoFlag::position_mode));
  enable();
  EXPECT_TRUE(bench_.flag(ServoFlag::position_mode));
  EXPECT_FALSE(bench_.flag(ServoFlag::velocity_mode));
  EXPECT_FALSE(bench_.flag(ServoFlag::torque_mode));
  EXPECT_FALSE(bench_.flag(ServoFlag::stop_mode));
  EXPECT_FALSE(bench_.flag(ServoFlag::free_running));
  EXPECT_EQ(bench_.axis->flags().bits() & (1U << 16), 0U);
}

TEST_F(ServoSupervision, TheMotorIsHaltedBelowItsParameter) {
  bench_.write(0x60FF, 300);
  bench_.write(0x6083, 20'000);
  bench_.enable(ModeCode::profile_velocity);
  bench_.pass(1_s);
  EXPECT_FALSE(bench_.flag(ServoFlag::motor_halted));
  EXPECT_TRUE(bench_.status(statusword::kMotorActivity));
  bench_.axis->servo_settings().controller.motor_halted_velocity = 400;
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.flag(ServoFlag::motor_halted));
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
}

TEST_F(ServoSupervision, ADisabledAxisKeepsCounting) {
  bench_.motor.turn_to(2500.0);
  bench_.pass(2_ms);
  EXPECT_EQ(bench_.position(), 2500);
  EXPECT_EQ(bench_.read(0x6062), 2500);
  enable();
  bench_.pass(100_ms);
  EXPECT_NEAR(bench_.motor.counts(), 2500.0, 10.0) << "it holds where it was enabled";
}

TEST_F(ServoSupervision, PositionsCountHallStepsWithHallCommutation) {
  bench_.axis->servo_settings().controller.commutation = control::ServoCommutation::hall;
  bench_.pass(2_ms);
  EXPECT_EQ(bench_.position(), 0) << "another sensor begins at 0";
  bench_.motor.load = 0.005;
  bench_.pass(300_ms);
  EXPECT_NEAR(static_cast<double>(bench_.position()), bench_.motor.counts() * 24.0 / 4000.0, 1.5);
  EXPECT_GT(bench_.position(), 24);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), bench_.rpm(), 0.1 * bench_.rpm());
}

TEST_F(ServoSupervision, SettingThePositionMovesNothing) {
  enable();
  bench_.axis->set_position(777);
  bench_.pass(100_ms);
  EXPECT_EQ(bench_.read(0x6062), 777);
  EXPECT_NEAR(static_cast<double>(bench_.position()), 777.0, 1.0);
  EXPECT_NEAR(bench_.motor.counts(), 0.0, 3.0);
}

TEST_F(ServoSupervision, LimitSwitchesTellOncePerTouchOutsideHoming) {
  bench_.left_switch = 1e6;
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.axis->errors().has(AxisError::negative_limit_switch));
  EXPECT_EQ(bench_.sentences.size(), 1U);
  bench_.pass(100_ms);
  EXPECT_EQ(bench_.sentences.size(), 1U);
  bench_.write(0x6060, 6);
  bench_.pass(2_ms);
  EXPECT_FALSE(bench_.axis->errors().has(AxisError::negative_limit_switch));
}

TEST_F(ServoSupervision, SoftwareLimitsAreComparedWithTheActualPosition) {
  bench_.write(0x607D, 1, -1000);
  bench_.write(0x607D, 2, 1000);
  bench_.write(0x607C, 100);
  bench_.motor.turn_to(905.5);
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.axis->errors().empty()) << "as near as positioning counts as finished";
  bench_.motor.turn_to(906.5);
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.axis->errors().has(AxisError::positive_software_limit));
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  bench_.motor.turn_to(901.5);
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.axis->errors().has(AxisError::positive_software_limit))
      << "it goes where the axis is back";
  bench_.motor.turn_to(-1104.5);
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.axis->errors().empty());
  bench_.motor.turn_to(-1106.5);
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.axis->errors().has(AxisError::negative_software_limit));
}

}  // namespace
}  // namespace stator::drive
