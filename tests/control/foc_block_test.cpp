// One PWM period of the TMC8670's FOC block: transformations, motion modes, limits, filters,
// feed-forward.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <gtest/gtest.h>

#include "control/foc_test_block.hpp"

namespace stator::control::foc {
namespace {

TEST(FocBlock, TransformsCurrentsOfThreePhaseMotors) {
  FocBlock block = block_in(0);
  block.step(with_currents(1000, -500));
  EXPECT_EQ(block.get(field("PID_FLUX_ACTUAL")), 1000);
  EXPECT_EQ(block.get(field("PID_TORQUE_ACTUAL")), 0);
  block.set(field("PHI_E_EXT"), 16384);
  block.step(with_currents(0, -866));
  EXPECT_EQ(block.get(field("FOC_IA")), 0);
  EXPECT_EQ(block.get(field("FOC_IB")), 1000);
  EXPECT_EQ(block.get(field("PID_FLUX_ACTUAL")), 1000);
  EXPECT_EQ(block.get(field("PID_TORQUE_ACTUAL")), 0);
}

TEST(FocBlock, TwoPhaseMotorsSkipClarke) {
  FocBlock block = block_in(8);
  block.set(field("MOTOR_TYPE"), 2);
  block.set(field("UD_EXT"), 8192);
  block.set(field("PHI_E_EXT"), 16384);
  block.step(with_currents(300, 400));
  EXPECT_EQ(block.get(field("FOC_IA")), 300);
  EXPECT_EQ(block.get(field("FOC_IB")), 400);
  EXPECT_EQ(block.get(field("FOC_ID")), 400);
  EXPECT_EQ(block.get(field("FOC_IQ")), -300);
  const Outputs& outputs = block.step(with_currents(300, 400));
  // 90 degrees: U_D drives Y.
  EXPECT_EQ(outputs.pwm.on_time, (std::array<std::int32_t, 4>{2000, 2000, 2500, 1500}));
  EXPECT_EQ(outputs.pwm.half_bridges, 4);
}

TEST(FocBlock, DirectCurrentMotorsSkipAllTransforms) {
  FocBlock block = block_in(1);
  block.set(field("MOTOR_TYPE"), 1);
  block.set(field("PHI_E_EXT"), 12345);
  block.set(field("PID_TORQUE_TARGET"), 8492);
  block.step(with_currents(300, 999));
  EXPECT_EQ(block.get(field("PID_TORQUE_ACTUAL")), 300);
  EXPECT_EQ(block.get(field("PID_FLUX_ACTUAL")), 0);
  EXPECT_EQ(block.get(field("FOC_UQ")), 8192);
  const Outputs& outputs = block.step(with_currents(300, 999));
  EXPECT_EQ(outputs.pwm.on_time, (std::array<std::int32_t, 4>{2500, 1500, 0, 0}));
  EXPECT_EQ(outputs.pwm.half_bridges, 2);
}

TEST(FocBlock, OnTimesTakeEffectInTheNextPeriod) {
  FocBlock block = block_in(8);
  block.step({});
  block.set(field("UD_EXT"), 16384);
  EXPECT_EQ(block.step({}).pwm.on_time[0], 2000);
  EXPECT_EQ(block.step({}).pwm.on_time[0], 3000);
  block.set(field("MODE_MOTION"), 0);
  EXPECT_EQ(block.step({}).pwm.on_time[0], 3000);
  EXPECT_EQ(block.step({}).pwm.on_time[0], 2000);
}

TEST(FocBlock, VoltagesComeFromTheRegistersInModeEight) {
  FocBlock block = block_in(8);
  block.write(0x24, 3000U << 16U | 4000U);
  block.step({});
  EXPECT_EQ(block.get(field("FOC_UD")), 4000);
  EXPECT_EQ(block.get(field("FOC_UQ")), 3000);
  EXPECT_EQ(block.get(field("FOC_UA")), 4000);
  EXPECT_EQ(block.get(field("FOC_UUX")), 4000);
  EXPECT_EQ(block.get(field("FOC_UV")), 598);
  EXPECT_EQ(block.get(field("FOC_UWY")), -4598);
  EXPECT_EQ(block.get(field("PWM_UX")), 2244);
}

TEST(FocBlock, VoltagesAreLimitedToTheCircle) {
  FocBlock block = block_in(8);
  block.write(0x7C, 0);
  block.write(0x24, 30000U << 16U);
  block.step({});
  EXPECT_EQ(block.get(field("FOC_UQ")), 30000);
  EXPECT_EQ(block.get(field("FOC_UQ_LIMITED")), 23169);
  EXPECT_EQ(block.get(field("IPARK_CIRLIM_LIMIT_U_Q")), 1);
  EXPECT_EQ(block.get(field("IPARK_CIRLIM_LIMIT_U_D")), 0);
  EXPECT_EQ(block.get(field("IPARK_CIRLIM_LIMIT_U_R")), 1);
  block.set(field("PIDOUT_UQ_UD_LIMITS"), 32767);
  block.step({});
  EXPECT_EQ(block.get(field("FOC_UQ_LIMITED")), 30000);
}

TEST(FocBlock, TorqueModeControlsBothCurrents) {
  FocBlock block = block_in(1);
  block.write(0x64, 2000U << 16U | 500U);
  block.step(with_currents(100, 0));
  EXPECT_EQ(block.get(field("PID_FLUX_ERROR")), 400);
  EXPECT_EQ(block.get(field("FOC_UD")), 400);
  EXPECT_EQ(block.get(field("FOC_UQ")), 2000 - block.get(field("PID_TORQUE_ACTUAL")));
  EXPECT_EQ(block.get(field("PID_TORQUE_TARGET_INTERIM")), 2000);
}

TEST(FocBlock, TargetsAreLimitedThenOffset) {
  FocBlock block = block_in(1);
  block.set(field("PID_TORQUE_FLUX_LIMITS"), 1500);
  block.set(field("PID_TORQUE_OFFSET"), 100);
  block.set(field("PID_TORQUE_TARGET"), 2000);
  block.write(0x7C, 0);
  block.step(with_currents(0, 0));
  EXPECT_EQ(block.get(field("PIDIN_TARGET_TORQUE")), 2000);
  EXPECT_EQ(block.get(field("PIDOUT_TARGET_TORQUE")), 1600);
  EXPECT_EQ(block.get(field("PID_IQ_TARGET_LIMIT")), 1);
  EXPECT_EQ(block.get(field("PID_ID_TARGET_LIMIT")), 0);
}

TEST(FocBlock, TargetsRiseNoFasterThanTheirRateLimit) {
  FocBlock block = block_in(1);
  block.set(field("PID_TORQUE_FLUX_TARGET_DDT_LIMITS"), 30);
  block.set(field("PID_TORQUE_TARGET"), 100);
  for (const int expected : {30, 60, 90, 100, 100}) {
    block.step(with_currents(0, 0));
    EXPECT_EQ(block.get(field("PIDOUT_TARGET_TORQUE")), expected);
  }
}

TEST(FocBlock, VelocityModeMakesTheTorqueTarget) {
  FocBlock block = block_in(2);
  block.set(field("PID_VELOCITY_TARGET"), 700);
  block.set(field("PID_VELOCITY_OFFSET"), 10);
  block.step(with_currents(0, 0));
  EXPECT_EQ(block.get(field("PID_VELOCITY_ERROR")), 710);
  EXPECT_EQ(block.get(field("PIDIN_TARGET_TORQUE")), 710);
  block.set(field("PID_VELOCITY_LIMIT"), 500);
  block.write(0x7C, 0);
  block.step(with_currents(0, 0));
  EXPECT_EQ(block.get(field("PIDOUT_TARGET_VELOCITY")), 510);
  EXPECT_EQ(block.get(field("PID_V_TARGET_LIMIT")), 1);
}

TEST(FocBlock, PositionModeMakesTheVelocityTarget) {
  FocBlock block = block_in(3);
  block.set(field("PID_POSITION_TARGET"), 300);
  block.step(with_currents(0, 0));
  EXPECT_EQ(block.get(field("PIDIN_TARGET_VELOCITY")), 300);
  EXPECT_EQ(block.get(field("PIDIN_TARGET_TORQUE")), 300);
  block.set(field("PID_POSITION_LIMIT_HIGH"), 200);
  block.step(with_currents(0, 0));
  EXPECT_EQ(block.get(field("PID_POSITION_ERROR")), 200);
  EXPECT_EQ(block.get(field("PID_X_TARGET_LIMIT")), 1);
  block.set(field("PID_POSITION_TARGET"), INT32_MIN);
  block.step(with_currents(0, 0));
  EXPECT_EQ(block.get(field("PIDOUT_TARGET_POSITION")), -INT32_MAX);
}

TEST(FocBlock, OuterLoopsAreEvaluatedInEveryNthPeriodOnly) {
  FocBlock block = block_in(2);
  block.set(field("MODE_PID_SMPL"), 4);
  block.step(with_currents(0, 0));
  block.set(field("PID_VELOCITY_TARGET"), 100);
  int evaluated = 0;
  for (int k = 0; k < 5; ++k) {
    block.step(with_currents(0, 0));
    evaluated += block.get(field("PIDIN_TARGET_TORQUE")) == 100 ? 1 : 0;
  }
  EXPECT_EQ(evaluated, 1);
}

TEST(FocBlock, VelocityFeedForwardAddsTheDerivativeOfTheTarget) {
  FocBlock block = block_in(3);
  block.set(field("PID_POSITION_P"), 0);
  block.set(field("MODE_FF"), 1);
  block.set(field("FEED_FORWARD_VELOCITY_GAIN"), 2 << 16);
  for (int k = 1; k < 10; ++k) {
    block.set(field("PID_POSITION_TARGET"), 50 * k);
    block.step(with_currents(0, 0));
    EXPECT_EQ(block.get(field("PIDIN_TARGET_VELOCITY")), 100);
    EXPECT_EQ(block.get(field("FF_VELOCITY")), 100);
  }
}

TEST(FocBlock, TorqueFeedForwardAddsTheDerivativeOfTheVelocityTarget) {
  FocBlock block = block_in(2);
  block.set(field("PID_VELOCITY_P"), 0);
  block.set(field("MODE_FF"), 2);
  block.set(field("FEED_FORWARD_TORQUE_GAIN"), 3 << 16);
  for (int k = 1; k < 10; ++k) {
    block.set(field("PID_VELOCITY_TARGET"), 7 * k);
    block.step(with_currents(0, 0));
    EXPECT_EQ(block.get(field("PIDIN_TARGET_TORQUE")), 21);
    EXPECT_EQ(block.get(field("FF_TORQUE")), 21);
  }
}

TEST(FocBlock, FiltersActOnTheirOwnSignal) {
  struct Row {
    int mode;
    Field enable, b0, a1, target, shown;
  };
  for (const Row& row :
       {Row{1, field("BIQUAD_T_ENABLE"), field("BIQUAD_T_B_0"), field("BIQUAD_T_A_1"),
            field("PID_TORQUE_TARGET"), field("PIDOUT_TARGET_TORQUE")},
        Row{1, field("BIQUAD_F_ENABLE"), field("BIQUAD_F_B_0"), field("BIQUAD_F_A_1"),
            field("PID_FLUX_TARGET"), field("PIDOUT_TARGET_FLUX")},
        Row{3, field("BIQUAD_X_ENABLE"), field("BIQUAD_X_B_0"), field("BIQUAD_X_A_1"),
            field("PID_POSITION_TARGET"), field("PIDOUT_TARGET_POSITION")}}) {
    FocBlock block = block_in(row.mode);
    block.set(row.enable, 1);
    block.set(row.b0, 1 << 28);  // y = x / 2 + y / 2
    block.set(row.a1, 1 << 28);
    block.step(with_currents(0, 0));
    block.set(row.target, 800);
    for (const int expected : {400, 600, 700, 750, 775}) {
      block.step(with_currents(0, 0));
      EXPECT_EQ(block.get(row.shown), expected);
    }
  }
}

TEST(FocBlock, VelocityFilterActsOnTheActualVelocity) {
  FocBlock block = block_in(0);
  block.set(field("VELOCITY_SELECTION"), 2);
  block.set(field("OPENLOOP_ACCELERATION"), 0xFFFFF);
  block.set(field("OPENLOOP_VELOCITY_TARGET"), 1000);
  block.set(field("BIQUAD_V_ENABLE"), 1);
  block.set(field("BIQUAD_V_B_0"), 1 << 28);  // half
  for (int k = 0; k < 1000; ++k) {
    block.step({});
  }
  EXPECT_NEAR(block.get(field("PID_VELOCITY_ACTUAL")), 500, 1);
}

TEST(FocBlock, OpenLoopTurnsTheFieldWithoutSensorAndCurrent) {
  FocBlock block = block_in(8);
  block.set(field("PHI_E_SELECTION"), 2);
  block.set(field("UD_EXT"), 8000);
  block.set(field("OPENLOOP_ACCELERATION"), 60'000);
  block.set(field("OPENLOOP_VELOCITY_TARGET"), 600);
  for (int k = 0; k < 5000; ++k) {
    block.step({});
    const double angle = block.get(field("OPENLOOP_PHI")) / 65536.0 * 2.0 * M_PI;
    ASSERT_NEAR(block.get(field("FOC_UA")), 8000.0 * std::cos(angle), 0.51);
    ASSERT_NEAR(block.get(field("FOC_UB")), 8000.0 * std::sin(angle), 0.51);
  }
  EXPECT_EQ(block.get(field("OPENLOOP_VELOCITY_ACTUAL")), 600);
}

}  // namespace
}  // namespace stator::control::foc
