// Every mode of the axis on the FOC block moves a motor as it should.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "drive/foc_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;
using control::foc::field;

class FocModes : public testing::Test {
 protected:
  FocBench bench_;
};

TEST_F(FocModes, ProfilePositionTravelsToTheTargetOnTheProfile) {
  bench_.set_profile(1000, 10'000, 10'000);
  bench_.enable(ModeCode::profile_position);
  EXPECT_EQ(bench_.read(0x6061), 1);
  bench_.write(0x607A, 10 * FocBench::kTurn);
  bench_.start();
  bench_.pass(300_ms);
  EXPECT_NEAR(bench_.rpm(), 1000.0, 10.0);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), 1000.0, 10.0);
  EXPECT_EQ(bench_.read(0x606B), 1000);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
  // 10 turns at 1000 rpm and one tenth of a second for a ramp: 0.7 s until the demand stands.
  bench_.pass(375_ms);
  EXPECT_NE(bench_.read(0x6062), 10 * FocBench::kTurn);
  bench_.pass(50_ms);
  EXPECT_EQ(bench_.read(0x6062), 10 * FocBench::kTurn);
  bench_.pass(300_ms);
  EXPECT_TRUE(bench_.status(statusword::kTargetReached));
  EXPECT_NEAR(bench_.revolutions(), 10.0, 0.002);
  EXPECT_EQ(bench_.read(0x6063), bench_.get(field("PID_POSITION_ACTUAL")));
}

TEST_F(FocModes, ProfileVelocityHoldsTheSpeedUnderLoad) {
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, -1500);
  bench_.pass(500_ms);
  EXPECT_NEAR(bench_.rpm(), -1500.0, 5.0);
  bench_.plant.set_external_torque(0.02);
  bench_.pass(500_ms);
  EXPECT_NEAR(bench_.rpm(), -1500.0, 5.0);
  EXPECT_LT(bench_.read(0x6077), -300) << "0.02 Nm are 0.64 A";
}

TEST_F(FocModes, CyclicVelocityFollowsWithoutARamp) {
  bench_.write(0x6083, 1);
  bench_.enable(ModeCode::cyclic_synchronous_velocity);
  bench_.write(0x60FF, 800);
  bench_.write(0x60B1, 100);
  bench_.pass(100_ms);
  EXPECT_NEAR(bench_.rpm(), 900.0, 10.0);
}

TEST_F(FocModes, CyclicTorqueSetsTheCurrentInQ) {
  bench_.plant.set_external_torque(-0.0312 * FocBench::kPeakCurrent * 0.5);
  bench_.enable(ModeCode::cyclic_synchronous_torque);
  bench_.write(0x6071, 450);
  bench_.write(0x60B2, 50);
  bench_.pass(20_ms);
  EXPECT_EQ(bench_.read(0x6074), 500);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x6077)), 500.0, 5.0);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x6078)), 500.0, 5.0);
  EXPECT_NEAR(bench_.plant.electromagnetic_torque(), 0.0312 * FocBench::kPeakCurrent * 0.5, 3e-4);
  EXPECT_NEAR(bench_.rpm(), 0.0, 60.0) << "load and motor are equal, but for the first ms";
}

TEST_F(FocModes, ASetPointFarAwayInUnitsOtherThanTheBlocksIsReached) {
  bench_.axis->foc_settings().counts_per_revolution = 10'000;
  bench_.pass(1_ms);
  bench_.set_profile(3000, 50'000, 50'000);
  bench_.enable(ModeCode::profile_position);
  bench_.write(0x607A, -123'456);
  bench_.start();
  ASSERT_TRUE(bench_.pass_until(
      [&] {
        return bench_.read(0x6062) == -123'456 && std::abs(bench_.position() + 123'456) <= 10;
      },
      2_s));
  EXPECT_NEAR(bench_.revolutions(), -12.3456, 0.002);
  EXPECT_EQ(bench_.read(0x6063), bench_.get(field("PID_POSITION_ACTUAL")));
  EXPECT_NEAR(static_cast<double>(bench_.read(0x6063)), -12.3456 * 65536.0, 131.0);
}

TEST_F(FocModes, PositionsGoOnWhereTheCounterOfTheBlockWraps) {
  bench_.axis->foc_settings().counts_per_revolution = 1000;
  bench_.pass(1_ms);
  bench_.block.set(field("PID_POSITION_ACTUAL"), 2'147'483'647 - 65'536);
  bench_.pass(1_ms);
  const std::int64_t before = bench_.position();
  EXPECT_NEAR(static_cast<double>(before), 32'767'000.0, 1.0);
  bench_.set_profile(3000, 50'000, 50'000);
  bench_.enable(ModeCode::profile_position);
  bench_.write(0x607A, before + 3000);
  bench_.start();
  bench_.pass(1_s);
  EXPECT_NEAR(static_cast<double>(bench_.position()), static_cast<double>(before) + 3000.0, 1.0);
  EXPECT_NEAR(bench_.revolutions(), 3.0, 0.003);
  EXPECT_LT(bench_.get(field("PID_POSITION_ACTUAL")), -2'000'000'000);
}

TEST_F(FocModes, ANewModeTakesOverWhenTheMotorStands) {
  bench_.write(0x6087, 0);
  bench_.enable(ModeCode::profile_torque);
  bench_.write(0x6071, 200);
  bench_.pass(100_ms);
  ASSERT_GT(bench_.rpm(), 500.0);
  bench_.write(0x6060, static_cast<std::int64_t>(ModeCode::profile_position));
  bench_.pass(1_ms);
  EXPECT_EQ(bench_.read(0x6061), 4);
  EXPECT_EQ(bench_.get(field("MODE_MOTION")), 2) << "brakes under velocity control";
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.read(0x6061) == 1; }, 2_s));
  bench_.pass(100_ms);
  EXPECT_EQ(bench_.get(field("MODE_MOTION")), 3);
  EXPECT_NEAR(bench_.rpm(), 0.0, 2.0);
}

TEST_F(FocModes, TargetsReachTheBlockWithTheFractionOfAUnit) {
  bench_.axis->foc_settings().counts_per_revolution = 100;
  bench_.pass(1_ms);
  bench_.set_profile(60, 100'000, 100'000);
  bench_.enable(ModeCode::profile_position);
  bench_.write(0x607A, 200);
  bench_.start();
  bench_.pass(300_ms);
  // 1 turn per second: 65.536 / 8 steps per period, though a unit is 655 of them.
  std::int32_t last = bench_.get(field("PID_POSITION_TARGET"));
  for (int k = 0; k < 100; ++k) {
    bench_.pass(125_us);
    const std::int32_t next = bench_.get(field("PID_POSITION_TARGET"));
    EXPECT_GE(next - last, 8);
    EXPECT_LE(next - last, 9);
    last = next;
  }
}

TEST_F(FocModes, PolarityTurnsPositionsVelocitiesAndTorquesRound) {
  bench_.axis->foc_settings().polarity = 0xC0;
  bench_.pass(1_ms);
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, 600);
  bench_.pass(300_ms);
  EXPECT_NEAR(bench_.rpm(), -600.0, 5.0);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), 600.0, 5.0);
  EXPECT_GT(bench_.position(), 65536);
  EXPECT_LT(bench_.revolutions(), -1.0);
  EXPECT_GT(bench_.read(0x6077), 0) << "friction";
}

TEST_F(FocModes, VelocityPolarityAloneLeavesPositionsAsTheyAre) {
  bench_.axis->foc_settings().polarity = 0x40;
  bench_.pass(1_ms);
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, 600);
  bench_.pass(300_ms);
  EXPECT_NEAR(bench_.rpm(), -600.0, 5.0);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), 600.0, 5.0);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606B)), 600.0, 1.0);
  EXPECT_LT(bench_.position(), -65536);
}

TEST_F(FocModes, AModeThat6502hDoesNotNameStandsStill) {
  dictionary::Entry& modes = *bench_.dictionary.find(0x6502, 0);
  modes.set_value(0x3AD & ~0x8U);
  bench_.enable(ModeCode::profile_torque);
  bench_.write(0x6071, 500);
  bench_.pass(50_ms);
  EXPECT_NEAR(bench_.rpm(), 0.0, 1.0);
}

TEST_F(FocModes, HaltStopsAsItsOptionSaysAndKeepsTheDriveEnabled) {
  struct Case {
    int option;
    double milliseconds;
  };
  for (const auto& [option, milliseconds] : {Case{1, 100.0}, Case{2, 25.0}}) {
    FocBench bench;
    bench.write(0x605D, option);
    bench.enable(ModeCode::profile_velocity);
    bench.write(0x60FF, 1000);
    bench.pass(300_ms);
    bench.write(0x6040, 0x10F);
    const base::SimTime begin = bench.now;
    ASSERT_TRUE(bench.pass_until([&] { return bench.read(0x606B) == 0; }, 1_s));
    EXPECT_NEAR((bench.now - begin).seconds() * 1e3, milliseconds, 0.5) << option;
    bench.pass(100_ms);
    EXPECT_TRUE(bench.status(statusword::kTargetReached));
    EXPECT_EQ(bench.axis->power_state(), PowerState::operation_enabled);
    bench.write(0x6040, 0x0F);
    bench.pass(300_ms);
    EXPECT_NEAR(bench.rpm(), 1000.0, 10.0);
  }
}

TEST_F(FocModes, HaltAtTheCurrentLimitStopsFasterThanAnyRamp) {
  bench_.write(0x605D, 3);
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, 2000);
  bench_.pass(400_ms);
  bench_.write(0x6040, 0x10F);
  bench_.pass(10_ms);
  EXPECT_EQ(bench_.read(0x606B), 0);
  EXPECT_LT(bench_.rpm(), 1500.0) << "1.4 A brake with 88000 rpm/s";
}

TEST_F(FocModes, QuickStopBrakesWithItsDecelerationAndDisablesTheDrive) {
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, 1000);
  bench_.pass(300_ms);
  bench_.write(0x6040, 0x0B);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::quick_stop_active);
  const base::SimTime begin = bench_.now;
  ASSERT_TRUE(bench_.pass_until(
      [&] { return bench_.axis->power_state() == PowerState::switch_on_disabled; }, 1_s));
  EXPECT_GE((bench_.now - begin).seconds(), 0.025);
  // The velocity loop of this bench overshoots, and the power stays until the shaft stands.
  EXPECT_LT((bench_.now - begin).seconds(), 0.1);
  EXPECT_NEAR(bench_.rpm(), 0.0, 10.0);
  bench_.pass(2_ms);
  EXPECT_EQ(bench_.get(field("MODE_MOTION")), 0);
  EXPECT_EQ(bench_.get(field("PWM_CHOP")), 0);
  EXPECT_FALSE(bench_.block.outputs().enable);
}

TEST_F(FocModes, ADisabledMotorCanBeTurnedAndIsTakenOverWhereItStands) {
  bench_.plant.set_external_torque(0.002);
  bench_.pass(300_ms);
  bench_.plant.set_external_torque(0.0);
  bench_.pass(500_ms);
  const double stands = bench_.revolutions();
  ASSERT_GT(stands, 0.5);
  bench_.enable(ModeCode::profile_position);
  bench_.pass(200_ms);
  EXPECT_NEAR(bench_.revolutions(), stands, 0.01);
  EXPECT_NEAR(static_cast<double>(bench_.position()), stands * 65536.0, 70.0);
}

}  // namespace
}  // namespace stator::drive
