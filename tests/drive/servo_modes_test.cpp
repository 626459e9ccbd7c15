// Profile position and profile velocity of a servo axis, and what changes between them.

#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <gtest/gtest.h>

#include "drive/servo_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;

class ServoProfilePosition : public testing::Test {
 protected:
  ServoProfilePosition() {
    bench_.set_profile(3000, 20'000, 20'000);
    bench_.enable(ModeCode::profile_position);
  }
  [[nodiscard]] bool arrives_at(std::int64_t target, base::SimDuration longest = 5_s) {
    return bench_.pass_until(
        [&] {
          return bench_.status(statusword::kTargetReached) &&
                 std::llabs(bench_.position() - target) <= 1;
        },
        longest);
  }
  ServoBench bench_;
};

TEST_F(ServoProfilePosition, TravelsToTheTargetAndStaysThere) {
  bench_.write(0x607A, 40'000);
  bench_.pass(100_ms);
  EXPECT_EQ(bench_.read(0x6062), 0) << "no motion before bit 4 rises";
  bench_.start();
  bench_.pass(10_ms);
  EXPECT_TRUE(bench_.status(statusword::kSetPointAcknowledge));
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
  EXPECT_TRUE(arrives_at(40'000));
  bench_.pass(2_s);
  EXPECT_EQ(bench_.read(0x6062), 40'000);
  EXPECT_NEAR(static_cast<double>(bench_.position()), 40'000.0, 1.0);
  EXPECT_EQ(bench_.read(0x6063), bench_.read(0x6064));
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
}

TEST_F(ServoProfilePosition, PositionLoopHoldsAgainstALoad) {
  bench_.motor.load = 0.02;
  bench_.pass(2_s);
  EXPECT_NEAR(bench_.motor.counts(), 0.0, 60.0);
  EXPECT_GT(-bench_.read(0x6077), 500) << "mA against the load";
}

TEST_F(ServoProfilePosition, ProfileVelocityAndMaxVelocityBoundTheTravel) {
  bench_.write(0x607A, 400'000);
  bench_.start();
  bench_.pass(400_ms);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), 3000.0, 40.0);
  bench_.axis->servo_settings().controller.maximum_velocity = 1000;
  bench_.pass(400_ms);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), 1000.0, 40.0);
}

TEST_F(ServoProfilePosition, AProfileVelocityOfZeroMeansMaxVelocity) {
  bench_.write(0x6081, 0);
  bench_.axis->servo_settings().controller.maximum_velocity = 1500;
  bench_.write(0x607A, 400'000);
  bench_.start();
  bench_.pass(500_ms);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), 1500.0, 40.0);
}

TEST_F(ServoProfilePosition, MaxAccelerationBoundsTheRamps) {
  bench_.axis->servo_settings().maximum_acceleration = 1000;
  bench_.pass(2_ms);
  bench_.write(0x607A, 400'000);
  bench_.start();
  bench_.pass(500_ms);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), 500.0, 40.0);
  EXPECT_EQ(bench_.read(0x6083), 20'000) << "the object keeps what was written";
}

TEST_F(ServoProfilePosition, WithoutAccelerationThereIsNoMotion) {
  bench_.write(0x6083, 0);
  bench_.write(0x607A, 400'000);
  bench_.start();
  bench_.pass(300_ms);
  EXPECT_EQ(bench_.read(0x6062), 0);
}

TEST_F(ServoProfilePosition, ANewSetPointIsTakenOverAtOnce) {
  bench_.write(0x607A, 400'000);
  bench_.start();
  bench_.pass(200_ms);
  bench_.write(0x607A, -4000);
  bench_.start();
  EXPECT_TRUE(arrives_at(-4000));
}

TEST_F(ServoProfilePosition, BitsFiveAndNineChangeNothing) {
  bench_.write(0x607A, 4000);
  bench_.write(0x6040, 0x0F | 0x220);
  bench_.write(0x6040, 0x1F | 0x220);
  EXPECT_TRUE(arrives_at(4000));
  EXPECT_FALSE(bench_.status(statusword::kFollowingError));
}

TEST_F(ServoProfilePosition, RelativeTargetsCountFromThePreviousTarget) {
  bench_.write(0x607A, 10'000);
  bench_.start();
  bench_.pass(50_ms);  // on its way
  bench_.write(0x607A, 5000);
  bench_.write(0x6040, 0x0F);
  bench_.write(0x6040, 0x5F);
  EXPECT_TRUE(arrives_at(15'000));
}

TEST_F(ServoProfilePosition, HaltStopsAndTheMoveResumes) {
  bench_.write(0x607A, 100'000);
  bench_.start();
  bench_.pass(200_ms);
  bench_.write(0x6040, 0x11F);
  bench_.pass(600_ms);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
  EXPECT_LT(bench_.position(), 99'000);
  bench_.write(0x6040, 0x1F);
  EXPECT_TRUE(arrives_at(100'000));
}

TEST_F(ServoProfilePosition, TheWindowIsInclusiveAndSeesTheActualPosition) {
  bench_.write(0x6067, 20);
  bench_.write(0x607A, 4000);
  bench_.start();
  ASSERT_TRUE(arrives_at(4000));
  bench_.write(0x6040, 0x06);  // free to be turned by hand
  bench_.write(0x6040, 0x0F);
  bench_.write(0x607A, 8000);
  bench_.start();
  ASSERT_TRUE(arrives_at(8000));
  bench_.motor.blocked = true;
  bench_.motor.turn_to(8020.5);
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.status(statusword::kTargetReached));
  bench_.motor.turn_to(8021.5);
  bench_.pass(2_ms);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
}

TEST_F(ServoProfilePosition, AWindowOfZeroLooksAtTheDemandAndAtTheShaft) {
  bench_.write(0x6067, 0);
  bench_.motor.blocked = true;
  bench_.write(0x607A, 2000);
  bench_.start();
  bench_.pass(20_ms);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
  EXPECT_TRUE(bench_.pass_until([&] { return bench_.read(0x6062) == 2000; }, 3_s));
  bench_.pass(10_ms);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
  bench_.motor.blocked = false;
  EXPECT_TRUE(bench_.pass_until([&] { return bench_.status(statusword::kTargetReached); }, 3_s));
  EXPECT_NEAR(static_cast<double>(bench_.position()), 2000.0, 5.0);
}

TEST_F(ServoProfilePosition, WithoutAWindowPositionEndCounts) {
  bench_.motor.blocked = true;
  bench_.write(0x607A, 2000);
  bench_.start();
  bench_.pass(2_s);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached)) << "the shaft has not moved";
  EXPECT_FALSE(bench_.flag(ServoFlag::position_end));
  bench_.axis->servo_settings().target_reached_distance = 3000;
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.status(statusword::kTargetReached));
  EXPECT_TRUE(bench_.flag(ServoFlag::position_end));
}

TEST_F(ServoProfilePosition, PositionEndNeedsALowVelocity) {
  bench_.axis->servo_settings().target_reached_distance = 1'000'000;
  bench_.axis->servo_settings().target_reached_velocity = 500;
  bench_.write(0x607A, 400'000);
  bench_.start();
  bench_.pass(400_ms);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
}

TEST_F(ServoProfilePosition, EndVelocityIsThereOnTheTargetAndStays) {
  bench_.write(0x6082, -600);  // its magnitude counts
  bench_.write(0x607A, 60'000);
  bench_.start();
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.read(0x6062) >= 60'000; }, 5_s));
  EXPECT_NEAR(bench_.axis->motion().velocity() * 60.0 / 4000.0, 600.0, 30.0);
  bench_.pass(500_ms);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), 600.0, 40.0);
  bench_.write(0x6082, 0);
  bench_.write(0x607A, 100'000);
  bench_.start();
  EXPECT_TRUE(arrives_at(100'000));
}

TEST_F(ServoProfilePosition, ATargetGivenUnderHaltIsTravelledToWhereverItLies) {
  bench_.write(0x6082, 600);
  bench_.write(0x607A, 60'000);
  bench_.start();
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.position() > 20'000; }, 5_s));
  bench_.write(0x6040, 0x010F);
  bench_.pass(1_s);
  bench_.write(0x607A, 4'000);
  bench_.write(0x6040, 0x011F);
  bench_.write(0x6040, 0x001F);
  bench_.pass(100_ms);
  EXPECT_LT(bench_.rpm(), -500.0) << "not on behind the target of before";
}

TEST_F(ServoProfilePosition, WithoutRampTheTargetIsTheDemandAtOnce) {
  bench_.axis->settings().ramp.active = false;
  bench_.write(0x607A, 30'000);
  bench_.start();
  bench_.pass(1_ms);
  EXPECT_EQ(bench_.read(0x6062), 30'000);
  bench_.pass(50_ms);
  EXPECT_LE(std::abs(bench_.read(0x606C)), 4100) << "MaxVelocity holds";
  EXPECT_TRUE(arrives_at(30'000));
}

TEST_F(ServoProfilePosition, HaltBrakesFromWhereTheShaftIsWhenThereIsNoRamp) {
  bench_.axis->settings().ramp.active = false;
  bench_.write(0x607A, 400'000);
  bench_.start();
  bench_.pass(100_ms);
  bench_.write(0x6040, 0x11F);
  bench_.pass(2_s);
  EXPECT_LT(bench_.position(), 60'000);
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
}

TEST_F(ServoProfilePosition, TargetsAreClampedToTheCorrectedSoftwareLimits) {
  bench_.write(0x607D, 1, -1000);
  bench_.write(0x607D, 2, 10'000);
  bench_.write(0x607C, 200);
  bench_.write(0x607A, 50'000);
  bench_.start();
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  EXPECT_TRUE(arrives_at(9800));
  bench_.write(0x607A, -50'000);
  bench_.start();
  EXPECT_TRUE(arrives_at(-1200));
}

TEST_F(ServoProfilePosition, ALimitSwitchStopsOnTheRampAndBlocksItsDirectionOnly) {
  bench_.right_switch = 20'000;
  bench_.write(0x607A, 100'000);
  bench_.start();
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.sensing.right_switch; }, 3_s));
  bench_.pass(2_ms);
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  EXPECT_TRUE(bench_.axis->errors().has(AxisError::positive_limit_switch));
  EXPECT_GT(bench_.rpm(), 1000.0) << "it slows down, it does not stop dead";
  bench_.pass(2_s);
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
  const std::int64_t stopped = bench_.position();
  bench_.write(0x607A, 100'000);
  bench_.start();
  bench_.pass(200_ms);
  EXPECT_NEAR(static_cast<double>(bench_.position()), static_cast<double>(stopped), 2.0);
  bench_.write(0x607A, 1000);
  bench_.start();
  EXPECT_TRUE(arrives_at(1000));
  EXPECT_FALSE(bench_.axis->errors().has(AxisError::positive_limit_switch));
}

TEST_F(ServoProfilePosition, ATargetAwayFromTheSwitchIsTakenWhileTheMotorStillBrakes) {
  bench_.right_switch = 20'000;
  bench_.write(0x607A, 100'000);
  bench_.start();
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.sensing.right_switch; }, 3_s));
  bench_.pass(20_ms);
  ASSERT_GT(bench_.rpm(), 500.0);
  bench_.write(0x607A, 1000);
  bench_.start();
  EXPECT_TRUE(arrives_at(1000));
}

TEST_F(ServoProfilePosition, ATargetBehindTheSwitchIsNotTakenWhileTheMotorBrakes) {
  bench_.right_switch = 20'000;
  bench_.write(0x607A, 100'000);
  bench_.start();
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.sensing.right_switch; }, 3_s));
  bench_.pass(20_ms);
  bench_.write(0x607A, 90'000);
  bench_.start();
  bench_.pass(3_s);
  EXPECT_LT(bench_.position(), 50'000);
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
}

TEST_F(ServoProfilePosition, ASwitchThatIsNotUsedStopsNothing) {
  bench_.right_switch = 20'000;
  bench_.axis->settings().reference.switches.right.used = false;
  bench_.write(0x607A, 40'000);
  bench_.start();
  EXPECT_TRUE(arrives_at(40'000));
}

class ServoProfileVelocity : public testing::Test {
 protected:
  ServoProfileVelocity() { bench_.set_profile(0, 10'000, 5000); }
  ServoBench bench_;
};

TEST_F(ServoProfileVelocity, AVelocityAwayFromTheSwitchIsTakenWhileTheMotorStillBrakes) {
  bench_.enable(ModeCode::profile_velocity);
  bench_.right_switch = 20'000;
  bench_.write(0x60FF, 2000);
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.sensing.right_switch; }, 3_s));
  bench_.pass(20_ms);
  ASSERT_GT(bench_.rpm(), 500.0);
  bench_.write(0x60FF, -300);
  EXPECT_TRUE(bench_.pass_until([&] { return std::abs(bench_.rpm() + 300.0) < 10.0; }, 2_s));
  bench_.pass(5_s);
  EXPECT_NEAR(bench_.rpm(), -300.0, 10.0);
}

TEST_F(ServoProfileVelocity, TakesUpTheTargetWrittenBeforeAndTellsItReached) {
  bench_.write(0x60FF, 2000);
  bench_.pass(10_ms);
  EXPECT_EQ(bench_.rpm(), 0.0);
  bench_.enable(ModeCode::profile_velocity);
  bench_.pass(100_ms);
  EXPECT_NEAR(bench_.axis->set_point().velocity, 1020.0, 25.0);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
  bench_.pass(1_s);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), 2000.0, 20.0);
  EXPECT_TRUE(bench_.status(statusword::kTargetReached));
  EXPECT_TRUE(bench_.flag(ServoFlag::velocity_mode));
  bench_.write(0x60FF, 0);
  bench_.pass(200_ms);
  EXPECT_NEAR(bench_.axis->set_point().velocity, 1000.0, 25.0) << "6084h, not 6083h";
  bench_.pass(2_s);
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
}

TEST_F(ServoProfileVelocity, TheVelocityLoopHoldsNoPosition) {
  bench_.enable(ModeCode::profile_velocity);
  bench_.motor.turn_to(5000.0);
  bench_.pass(3_s);
  EXPECT_GT(bench_.motor.counts(), 1000.0) << "it has brought the shaft to rest, not back";
  EXPECT_EQ(bench_.axis->set_point().loop, control::ServoLoop::velocity);
  EXPECT_EQ(bench_.read(0x6062), bench_.read(0x6064));
}

TEST_F(ServoProfileVelocity, MaxVelocityBoundsTheDemand) {
  bench_.axis->servo_settings().controller.maximum_velocity = 700;
  bench_.pass(2_ms);
  bench_.write(0x60FF, 3000);
  bench_.enable(ModeCode::profile_velocity);
  bench_.pass(500_ms);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), 700.0, 20.0);
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
}

TEST_F(ServoProfileVelocity, WithoutRampTheTargetIsTheDemandAtOnce) {
  bench_.axis->settings().ramp.active = false;
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, -1500);
  bench_.pass(1_ms);
  EXPECT_EQ(bench_.axis->set_point().velocity, -1500.0);
}

TEST_F(ServoProfileVelocity, HaltBrakesAndTheVelocityResumes) {
  bench_.write(0x60FF, 1000);
  bench_.enable(ModeCode::profile_velocity);
  bench_.pass(300_ms);
  bench_.write(0x6040, 0x10F);
  bench_.pass(2_s);
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
  bench_.write(0x6040, 0x0F);
  bench_.pass(1_s);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), 1000.0, 20.0);
}

TEST_F(ServoProfileVelocity, ABlockedMotorHasNotReachedItsTarget) {
  bench_.motor.blocked = true;
  bench_.write(0x60FF, 1000);
  bench_.enable(ModeCode::profile_velocity);
  bench_.pass(500_ms);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
}

TEST_F(ServoProfileVelocity, StopsBehindASoftwareLimitAndMayComeBack) {
  bench_.write(0x607D, 2, 20'000);
  bench_.write(0x60FF, 600);
  bench_.enable(ModeCode::profile_velocity);
  ASSERT_TRUE(bench_.pass_until(
      [&] { return bench_.axis->errors().has(AxisError::positive_software_limit); }, 3_s));
  EXPECT_GT(bench_.position(), 20'000);
  bench_.pass(2_s);
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  bench_.write(0x60FF, 500);
  bench_.pass(100_ms);
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity)) << "outward stays blocked";
  bench_.write(0x60FF, -500);
  bench_.pass(1_s);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), -500.0, 20.0);
  EXPECT_TRUE(bench_.status(statusword::kNegativeDirection));
}

TEST_F(ServoProfileVelocity, DirectionStaysAtStandstill) {
  bench_.write(0x60FF, -500);
  bench_.enable(ModeCode::profile_velocity);
  bench_.pass(300_ms);
  EXPECT_TRUE(bench_.status(statusword::kMotorActivity));
  bench_.motor.blocked = true;
  bench_.pass(100_ms);
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
  EXPECT_TRUE(bench_.status(statusword::kNegativeDirection));
}

TEST_F(ServoProfileVelocity, AChangeToPositioningStopsOnTheRampAndShowsTheModeThen) {
  bench_.write(0x60FF, 1000);
  bench_.enable(ModeCode::profile_velocity);
  bench_.pass(300_ms);
  bench_.write(0x6060, 1);
  bench_.pass(50_ms);
  EXPECT_EQ(bench_.read(0x6061), 3);
  EXPECT_GT(bench_.rpm(), 500.0);
  bench_.pass(2_s);
  EXPECT_EQ(bench_.read(0x6061), 1);
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
  EXPECT_EQ(bench_.axis->set_point().loop, control::ServoLoop::position);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x6062)), bench_.motor.counts(), 30.0);
}

TEST_F(ServoProfileVelocity, ModeZeroStopsTheMotor) {
  bench_.write(0x60FF, 1000);
  bench_.enable(ModeCode::profile_velocity);
  bench_.pass(300_ms);
  EXPECT_FALSE(bench_.flag(ServoFlag::stop_mode));
  bench_.write(0x6060, 0);
  bench_.pass(2_s);
  EXPECT_EQ(bench_.read(0x6061), 0);
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
  EXPECT_TRUE(bench_.flag(ServoFlag::stop_mode));
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
}

}  // namespace
}  // namespace stator::drive
