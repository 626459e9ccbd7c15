// Torque of the axis on the FOC block: its slope, its limits and what feeds it forward.

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

/// A motor that hardly turns, so that time is left to look at torques.
class FocProfileTorque : public testing::Test {
 protected:
  static plant::PwmAxisParameters heavy() {
    plant::PwmAxisParameters result = foc_plant();
    result.load.inertia = 2e-3;
    return result;
  }
  FocProfileTorque() {
    bench_.block.set(field("PID_VELOCITY_P"), 32'767);
    bench_.block.set(field("PID_VELOCITY_I"), 2);
  }
  FocBench bench_{heavy()};
};

TEST_F(FocProfileTorque, ApproachesTheTargetWithTheSlope) {
  bench_.write(0x6087, 4000);
  bench_.enable(ModeCode::profile_torque);
  EXPECT_EQ(bench_.read(0x6061), 4);
  bench_.write(0x6071, 600);
  const double begin = bench_.now.seconds();
  for (int k = 0; k < 1500; ++k) {
    bench_.pass(125_us);
    const double exact = std::min(4000.0 * (bench_.now.seconds() - begin), 600.0);
    EXPECT_NEAR(static_cast<double>(bench_.read(0x6074)), exact, 0.51);
    // The current follows within its loop and the period in which the block learns of it.
    EXPECT_NEAR(static_cast<double>(bench_.read(0x6077)), exact, 4000.0 * 350e-6 + 3.0);
    EXPECT_EQ(bench_.status(statusword::kTargetReached), exact == 600.0);
  }
  const double turned = bench_.now.seconds();
  bench_.write(0x6071, -200);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
  for (int k = 0; k < 2000; ++k) {
    bench_.pass(125_us);
    const double exact = std::max(600.0 - 4000.0 * (bench_.now.seconds() - turned), -200.0);
    EXPECT_NEAR(static_cast<double>(bench_.read(0x6074)), exact, 0.51);
  }
  EXPECT_TRUE(bench_.status(statusword::kTargetReached));
  EXPECT_NEAR(bench_.plant.electromagnetic_torque(), -0.2 * FocBench::kPeakCurrent * 0.0312, 1e-4);
}

TEST_F(FocProfileTorque, ASlopeOfZeroTakesTheTargetAtOnce) {
  bench_.write(0x6087, 0);
  bench_.enable(ModeCode::profile_torque);
  bench_.write(0x6071, 500);
  bench_.pass(250_us);
  EXPECT_EQ(bench_.read(0x6074), 500);
}

TEST_F(FocProfileTorque, MaxTorqueAndMaxCurrentBoundIt) {
  bench_.axis->foc_settings().maximum_torque = 300;
  bench_.write(0x6087, 100'000);
  bench_.enable(ModeCode::profile_torque);
  bench_.write(0x6071, 800);
  bench_.pass(20_ms);
  EXPECT_EQ(bench_.read(0x6074), 300);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x6077)), 300.0, 5.0);
  EXPECT_EQ(bench_.get(field("PID_TORQUE_FLUX_LIMITS")), 424);  // 0.3 * 1414
  bench_.axis->foc_settings().maximum_current = 200;
  bench_.pass(20_ms);
  EXPECT_EQ(bench_.read(0x6074), 200);
  EXPECT_EQ(bench_.get(field("PID_TORQUE_FLUX_LIMITS")), 283);
}

TEST_F(FocProfileTorque, HaltBrakesTheMotorAndGoesOnFromNothing) {
  bench_.write(0x6087, 0);
  bench_.write(0x6084, 2000);
  bench_.enable(ModeCode::profile_torque);
  bench_.write(0x6071, 900);
  bench_.pass(500_ms);
  ASSERT_GT(bench_.rpm(), 80.0);
  bench_.write(0x6040, 0x10F);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
  EXPECT_TRUE(bench_.pass_until([&] { return bench_.status(statusword::kTargetReached); }, 1_s));
  bench_.pass(1_s);
  EXPECT_NEAR(bench_.rpm(), 0.0, 3.0);
  bench_.write(0x6087, 1000);
  bench_.write(0x6040, 0x0F);
  bench_.pass(100_ms);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x6074)), 100.0, 1.0);
}

TEST(FocTorque, FadesOutAtMaxMotorSpeed) {
  FocBench bench{linear_foc_plant()};
  bench.axis->foc_settings().maximum_speed = 2000;
  bench.write(0x6087, 0);
  bench.enable(ModeCode::profile_torque);
  bench.write(0x6071, 500);
  bench.pass(1_s);
  EXPECT_GT(bench.rpm(), 1900.0);
  EXPECT_LT(bench.rpm(), 2002.0) << "a step of the velocity register";
  EXPECT_LT(bench.read(0x6074), 20);
  bench.write(0x6071, -500);
  bench.pass(1_ms);
  EXPECT_EQ(bench.read(0x6074), -500) << "the way back is free";
}

TEST(FocTorque, OffsetsAreFeedForwardInCyclicPosition) {
  FocBench bench;
  bench.enable(ModeCode::cyclic_synchronous_position);
  bench.write(0x607A, 0);
  bench.write(0x60B1, 120);
  bench.write(0x60B2, -100);
  bench.pass(1_ms);
  EXPECT_EQ(bench.get(field("PID_VELOCITY_OFFSET")), 120);
  EXPECT_EQ(bench.get(field("PID_TORQUE_OFFSET")), -141);
  bench.write(0x6040, 0x10F);
  bench.pass(1_ms);
  EXPECT_EQ(bench.get(field("PID_VELOCITY_OFFSET")), 0) << "halt is no cyclic set-point";
  EXPECT_EQ(bench.get(field("PID_TORQUE_OFFSET")), 0);
}

TEST(FocTorque, OfACyclicVelocityOnlyTheTorqueOffsetIsFeedForward) {
  FocBench bench;
  bench.enable(ModeCode::cyclic_synchronous_velocity);
  bench.write(0x60FF, 100);
  bench.write(0x60B1, 120);
  bench.write(0x60B2, 100);
  bench.pass(2_ms);
  EXPECT_EQ(bench.get(field("PID_VELOCITY_TARGET")), 220);
  EXPECT_EQ(bench.get(field("PID_VELOCITY_OFFSET")), 0);
  EXPECT_EQ(bench.get(field("PID_TORQUE_OFFSET")), 141);
  bench.write(0x6060, 1);
  bench.pass(200_ms);
  EXPECT_EQ(bench.get(field("PID_TORQUE_OFFSET")), 0);
}

TEST(FocTorque, DemandIsWhatTheVelocityLoopAsksFor) {
  FocBench bench;
  bench.enable(ModeCode::profile_position);
  bench.plant.set_external_torque(0.02);
  bench.pass(500_ms);
  // 0.02 Nm, less what friction may hold, at 0.0312 Nm/A and 1.414 A.
  EXPECT_NEAR(static_cast<double>(bench.read(0x6074)), -453.0, 15.0);
  EXPECT_NEAR(static_cast<double>(bench.read(0x6077)), -453.0, 15.0);
}

}  // namespace
}  // namespace stator::drive
