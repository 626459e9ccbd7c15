// What the axis on the FOC block watches, and how it finds its commutation.

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "drive/foc_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;
using control::foc::field;

class FocSupervision : public testing::Test {
 protected:
  void reset_fault() {
    bench_.write(0x6040, 0x00);
    bench_.write(0x6040, 0x80);
    bench_.pass(1_ms);
  }
  FocBench bench_;
};

TEST_F(FocSupervision, FollowingErrorHasToLastAsLongAsItsTimeOut) {
  bench_.write(0x6065, 10'000);
  bench_.write(0x6066, 20);
  bench_.enable(ModeCode::cyclic_synchronous_position);
  bench_.write(0x607A, 16'000);  // within the window again after ln(1.6) / 50 s: 9 ms
  bench_.pass(2_ms);
  EXPECT_GT(bench_.read(0x60F4), 10'000);
  bench_.pass(15_ms);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
  bench_.pass(200_ms);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
  EXPECT_EQ(bench_.read(0x60F4), bench_.read(0x6062) - bench_.read(0x6064));
  bench_.axis->foc_settings().maximum_torque = 0;  // cannot follow
  bench_.write(0x607A, 56'000);
  bench_.pass(20_ms);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x60F4)), 40'000.0, 1500.0);
  bench_.pass(3_ms);
  EXPECT_NE(bench_.axis->power_state(), PowerState::operation_enabled);
  EXPECT_TRUE(bench_.told("following error"));
  bench_.pass(100_ms);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::fault);
}

TEST_F(FocSupervision, VoltageLimitsHaveHysteresis) {
  bench_.axis->foc_settings().undervoltage = 18.0;
  bench_.axis->foc_settings().overvoltage = 30.0;
  bench_.axis->foc_settings().voltage_hysteresis = 1.0;
  bench_.pass(1_ms);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x6079)), 24'000.0, 1.0);
  EXPECT_TRUE(bench_.status(statusword::kVoltageEnabled));
  bench_.plant.set_supply_voltage(17.5);
  bench_.pass(1_ms);
  EXPECT_FALSE(bench_.status(statusword::kVoltageEnabled));
  EXPECT_EQ(bench_.axis->power_state(), PowerState::switch_on_disabled) << "no power, no fault";
  bench_.plant.set_supply_voltage(18.5);
  bench_.pass(1_ms);
  EXPECT_FALSE(bench_.status(statusword::kVoltageEnabled));
  bench_.plant.set_supply_voltage(19.5);
  bench_.pass(1_ms);
  EXPECT_TRUE(bench_.status(statusword::kVoltageEnabled));
  bench_.enable(ModeCode::profile_position);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
  bench_.plant.set_supply_voltage(17.0);
  bench_.pass(5_ms);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::fault);
  bench_.plant.set_supply_voltage(31.0);
  bench_.pass(1_ms);
  reset_fault();
  EXPECT_EQ(bench_.axis->power_state(), PowerState::fault) << "overvoltage";
  bench_.plant.set_supply_voltage(24.0);
  bench_.pass(1_ms);
  reset_fault();
  EXPECT_EQ(bench_.axis->power_state(), PowerState::switch_on_disabled);
  bench_.enable(ModeCode::profile_position);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
}

TEST_F(FocSupervision, CurrentBeyondTheConverterSwitchesOffUntilTheReset) {
  bench_.enable(ModeCode::profile_position);
  bench_.block.set(field("ADC_I1_OFFSET"), 0);  // as if the amplifier stood at its end
  bench_.block.set(field("ADC_I1_SCALE"), 300);
  bench_.pass(1_ms);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::fault);
  EXPECT_TRUE(bench_.told("overcurrent in bridge C"));
  EXPECT_EQ(bench_.get(field("PWM_CHOP")), 0);
  bench_.block.set(field("ADC_I1_OFFSET"), 32768);
  bench_.block.set(field("ADC_I1_SCALE"), 256);
  bench_.pass(1_ms);
  reset_fault();
  bench_.enable(ModeCode::profile_position);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
}

TEST_F(FocSupervision, ShutdownSwitchTakesThePowerAway) {
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, 500);
  bench_.pass(100_ms);
  bench_.axis->conditions().shutdown_switch = true;
  bench_.pass(1_ms);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::fault);
  EXPECT_FALSE(bench_.axis->bridge_enabled());
  bench_.axis->conditions().shutdown_switch = false;
  bench_.pass(1_ms);
  reset_fault();
  EXPECT_EQ(bench_.axis->power_state(), PowerState::switch_on_disabled);
}

TEST_F(FocSupervision, VelocityIsReachedAfterItsTimeInTheWindow) {
  bench_.axis->foc_settings().velocity_window = 20;
  bench_.axis->foc_settings().velocity_window_time = 50;
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, 1000);
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.read(0x606B) == 1000; }, 1_s));
  bench_.pass(45_ms);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
  bench_.pass(60_ms);
  EXPECT_TRUE(bench_.status(statusword::kTargetReached)) << bench_.read(0x606C);
  bench_.plant.set_external_torque(-0.5);
  bench_.pass(20_ms);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
}

TEST_F(FocSupervision, SpeedCountsAfterItsTimeAboveTheThreshold) {
  bench_.axis->foc_settings().velocity_threshold = 500;
  bench_.axis->foc_settings().velocity_threshold_time = 30;
  bench_.enable(ModeCode::profile_velocity);
  EXPECT_TRUE(bench_.status(statusword::kSpeedZero));
  bench_.write(0x60FF, 1000);
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.read(0x606C) > 500; }, 1_s));
  bench_.pass(28_ms);
  EXPECT_TRUE(bench_.status(statusword::kSpeedZero));
  bench_.pass(5_ms);
  EXPECT_FALSE(bench_.status(statusword::kSpeedZero));
  bench_.write(0x60FF, 0);
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.read(0x606C) <= 500; }, 1_s));
  bench_.pass(250_us);
  EXPECT_TRUE(bench_.status(statusword::kSpeedZero));
}

TEST_F(FocSupervision, MaxSpeedsBoundRampsAndTheVelocityLoop) {
  bench_.axis->foc_settings().maximum_profile_velocity = 700;
  bench_.axis->foc_settings().maximum_speed = 900;
  bench_.pass(1_ms);
  bench_.set_profile(5000, 50'000, 50'000);
  bench_.enable(ModeCode::profile_position);
  bench_.write(0x607A, 100 * FocBench::kTurn);
  bench_.start();
  bench_.pass(200_ms);
  EXPECT_NEAR(bench_.rpm(), 700.0, 10.0);
  EXPECT_EQ(bench_.get(field("PID_VELOCITY_LIMIT")), 900);
}

/// A bench whose shaft stands at `degrees` (electrical) and whose encoder offset nobody knows.
struct UnknownRotor : FocBench {
  explicit UnknownRotor(double degrees, CommutationMethod method)
      : FocBench([&] {
          plant::PwmAxisParameters result = foc_plant();
          result.initial_revolutions = degrees / 360.0 / 4.0;
          return result;
        }()) {
    block.set(field("ABN_DECODER_PHI_E_OFFSET"), 12'345);
    axis->foc_settings().commutation.method = method;
    axis->foc_settings().commutation.hold_time = 400_ms;
  }
  [[nodiscard]] bool ready() const { return axis->commutation_known(); }
};

TEST(FocCommutationSearch, ByHallsRunsAtOnceAndHandsOverToTheEncoder) {
  for (const double degrees : {0.0, 100.0, -70.0}) {
    UnknownRotor bench(degrees, CommutationMethod::halls);
    bench.enable(ModeCode::profile_velocity);
    EXPECT_TRUE(bench.ready());
    EXPECT_EQ(bench.get(field("PHI_E_SELECTION")), 5);
    bench.write(0x60FF, 300);
    bench.pass(300_ms);
    EXPECT_EQ(bench.get(field("PHI_E_SELECTION")), 3);
    EXPECT_NEAR(bench.rpm(), 300.0, 5.0) << degrees;
    EXPECT_NEAR(bench.commutation_error(), 0.0, 5.0) << degrees;
  }
}

TEST(FocCommutationSearch, ImpossibleHallLevelsFailUntilTheReset) {
  UnknownRotor bench(30.0, CommutationMethod::halls);
  bench.halls = 7;
  bench.pass(1_ms);
  bench.enable(ModeCode::profile_velocity);
  bench.pass(1_ms);
  EXPECT_EQ(bench.axis->power_state(), PowerState::fault);
  EXPECT_TRUE(bench.axis->errors().has(AxisError::initialisation_error));
  bench.halls.reset();
  bench.pass(1_ms);
  bench.write(0x6040, 0x80);
  bench.pass(1_ms);
  bench.enable(ModeCode::profile_velocity);
  EXPECT_EQ(bench.axis->power_state(), PowerState::operation_enabled);
}

TEST(FocCommutationSearch, HallsThatBreakWhileTheyCommutateAreAnError) {
  UnknownRotor bench(30.0, CommutationMethod::halls);
  bench.enable(ModeCode::profile_velocity);
  bench.halls = 0;
  bench.pass(1_ms);
  EXPECT_TRUE(bench.axis->errors().has(AxisError::hall_error));
  EXPECT_EQ(bench.axis->power_state(), PowerState::fault);
}

TEST(FocCommutationSearch, BangBangPullsTheRotorToZeroFromAnywhere) {
  for (const double degrees : {0.0, 40.0, -100.0, 150.0, 180.0, 90.0}) {
    UnknownRotor bench(degrees, CommutationMethod::bang_bang);
    bench.enable(ModeCode::profile_position);
    EXPECT_FALSE(bench.ready()) << degrees;
    bench.write(0x607A, 5 * FocBench::kTurn);
    bench.start();
    bench.pass(700_ms);
    EXPECT_EQ(bench.read(0x6062), bench.read(0x6064)) << "set-points wait, the shaft is free";
    ASSERT_TRUE(bench.pass_until([&] { return bench.ready(); }, 200_ms)) << degrees;
    EXPECT_NEAR(bench.commutation_error(), 0.0, 5.0) << degrees;
    EXPECT_EQ(bench.get(field("PHI_E_SELECTION")), 3);
    EXPECT_EQ(bench.get(field("PID_FLUX_TARGET")), 0);
    bench.pass(1_s);
    EXPECT_NEAR(static_cast<double>(bench.position()), 5.0 * 65536.0, 200.0) << degrees;
  }
}

TEST(FocCommutationSearch, BangBangOfABlockedShaftFails) {
  UnknownRotor bench(20.0, CommutationMethod::bang_bang);
  bench.axis->foc_settings().commutation.current = 0.001;  // too little for the friction
  bench.enable(ModeCode::profile_position);
  bench.pass(900_ms);
  EXPECT_EQ(bench.axis->power_state(), PowerState::fault);
  EXPECT_TRUE(bench.told("commutation angle"));
  bench.axis->foc_settings().commutation.current = 1.0;
  bench.write(0x6040, 0x80);
  bench.pass(1_ms);
  bench.enable(ModeCode::profile_position);
  bench.pass(900_ms);
  EXPECT_TRUE(bench.ready());
  EXPECT_EQ(bench.axis->power_state(), PowerState::operation_enabled);
}

TEST(FocCommutationSearch, BangBangNoticesAnEncoderThatCountsBackwards) {
  UnknownRotor bench(20.0, CommutationMethod::bang_bang);
  bench.block.set(field("ABN_DIRECTION"), 1);
  bench.enable(ModeCode::profile_position);
  bench.pass(900_ms);
  EXPECT_EQ(bench.axis->power_state(), PowerState::fault);
}

TEST(FocCommutationSearch, MinimalMovementHardlyTurnsTheShaft) {
  for (const double degrees : {20.0, -60.0, 120.0}) {
    UnknownRotor bench(degrees, CommutationMethod::minimal_movement);
    bench.axis->foc_settings().commutation.minimal_movement_voltage = 1500;
    bench.block.set(field("UD_EXT"), 77);
    const double before = bench.revolutions();
    bench.enable(ModeCode::profile_position);
    EXPECT_FALSE(bench.ready());
    ASSERT_TRUE(bench.pass_until([&] { return bench.ready(); }, 1_s)) << degrees;
    EXPECT_LT(std::fabs(bench.revolutions() - before) * 4.0 * 360.0, 40.0) << degrees;
    EXPECT_NEAR(bench.commutation_error(), 0.0, 8.0) << degrees;
    EXPECT_EQ(bench.get(field("UD_EXT")), 77) << "as it was";
  }
}

TEST(FocCommutationSearch, MinimalMovementThatMovesTooFarFails) {
  UnknownRotor bench(120.0, CommutationMethod::minimal_movement);
  bench.axis->foc_settings().commutation.largest_movement = 100;
  bench.enable(ModeCode::profile_position);
  bench.pass(1_s);
  EXPECT_EQ(bench.axis->power_state(), PowerState::fault);
}

TEST(FocCommutationSearch, SwitchingOffEndsItAndTheNextStartBeginsAnew) {
  UnknownRotor bench(40.0, CommutationMethod::bang_bang);
  bench.enable(ModeCode::profile_position);
  bench.pass(200_ms);
  bench.write(0x6040, 0);
  bench.pass(1_ms);
  EXPECT_FALSE(bench.ready());
  EXPECT_EQ(bench.get(field("PID_FLUX_TARGET")), 0);
  EXPECT_EQ(bench.get(field("MODE_MOTION")), 0);
  bench.enable(ModeCode::profile_position);
  bench.pass(900_ms);
  EXPECT_TRUE(bench.ready());
  bench.write(0x6040, 0);
  bench.pass(1_ms);
  bench.enable(ModeCode::profile_position);
  EXPECT_TRUE(bench.ready()) << "what was found is kept";
}

}  // namespace
}  // namespace stator::drive
