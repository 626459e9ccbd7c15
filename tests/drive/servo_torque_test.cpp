// Torque of a servo axis.

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "drive/servo_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;

class ServoTorque : public testing::Test {
 protected:
  ServoTorque() {
    bench_.set_profile(0, 10'000, 20'000);
    bench_.enable(ModeCode::cyclic_synchronous_torque);
  }
  ServoBench bench_;
};

TEST_F(ServoTorque, TheTargetAndItsOffsetAreTheCurrent) {
  bench_.motor.blocked = true;
  bench_.write(0x6071, 1000);
  bench_.write(0x60B2, -250);
  bench_.pass(50_ms);
  EXPECT_EQ(bench_.axis->controller().target_current(), 750);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x6077)), 750.0, 20.0);
  EXPECT_TRUE(bench_.status(statusword::kTargetUsed));
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
  EXPECT_FALSE(bench_.status(statusword::kFollowingError));
  EXPECT_TRUE(bench_.flag(ServoFlag::torque_mode));
}

TEST_F(ServoTorque, MaxTorqueBoundsIt) {
  bench_.motor.blocked = true;
  bench_.axis->servo_settings().controller.maximum_torque = 600;
  bench_.write(0x6071, -1000);
  bench_.pass(50_ms);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x6077)), -600.0, 20.0);
}

TEST_F(ServoTorque, ATorqueTurnsTheMotorAndZeroLetsItCoast) {
  bench_.write(0x6071, 300);
  bench_.pass(100_ms);
  EXPECT_GT(bench_.rpm(), 300.0);
  EXPECT_EQ(bench_.read(0x6062), bench_.read(0x6064)) << "the demand follows the shaft";
  const double before = bench_.rpm();
  bench_.write(0x6071, 0);
  bench_.pass(20_ms);
  EXPECT_GT(bench_.rpm(), 0.8 * before);
}

TEST_F(ServoTorque, HaltTakesTheTorqueAwayAndGivesItBack) {
  bench_.motor.blocked = true;
  bench_.write(0x6071, 1000);
  bench_.pass(20_ms);
  bench_.write(0x6040, 0x10F);
  bench_.pass(200_ms);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x6077)), 0.0, 20.0);
  EXPECT_FALSE(bench_.status(statusword::kTargetUsed)) << "the target is ignored";
  bench_.write(0x6040, 0x0F);
  bench_.pass(200_ms);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x6077)), 1000.0, 20.0);
}

TEST_F(ServoTorque, QuickStopBrakesByTheVelocityRamp) {
  bench_.write(0x6071, 300);
  bench_.pass(100_ms);
  bench_.write(0x6085, 5000);
  const double before = bench_.rpm();
  bench_.write(0x6040, 0x0002);
  bench_.pass(100_ms);
  EXPECT_EQ(bench_.axis->set_point().loop, control::ServoLoop::velocity);
  EXPECT_LT(bench_.rpm(), before - 20.0);
  EXPECT_TRUE(bench_.pass_until(
      [&] { return bench_.axis->power_state() == PowerState::switch_on_disabled; }, 2_s));
}

TEST_F(ServoTorque, WithoutADecelerationItCoastsToItsStop) {
  bench_.write(0x605A, 1);
  bench_.write(0x6084, 0);
  bench_.write(0x6071, 300);
  bench_.pass(100_ms);
  const double before = bench_.rpm();
  bench_.write(0x6040, 0x0002);
  bench_.pass(20_ms);
  EXPECT_GT(bench_.rpm(), 0.8 * before);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::quick_stop_active);
  EXPECT_TRUE(bench_.pass_until(
      [&] { return bench_.axis->power_state() == PowerState::switch_on_disabled; }, 20_s));
}

TEST_F(ServoTorque, OutwardTorqueIsTakenAwayBehindASoftwareLimit) {
  bench_.write(0x607D, 2, 4000);
  bench_.write(0x6071, 200);
  ASSERT_TRUE(bench_.pass_until(
      [&] { return bench_.axis->errors().has(AxisError::positive_software_limit); }, 3_s));
  bench_.pass(2_s);
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  bench_.write(0x6071, -200);
  bench_.pass(200_ms);
  EXPECT_LT(bench_.rpm(), -50.0) << "inward is free";
}

}  // namespace
}  // namespace stator::drive
