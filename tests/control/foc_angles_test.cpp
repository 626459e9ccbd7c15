// Open-loop angle, velocity meters and angle selectors of the TMC8670's FOC block.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "stator/control/foc/foc_block.hpp"
#include "stator/control/foc/open_loop_generator.hpp"
#include "stator/control/foc/velocity_meter.hpp"

namespace stator::control::foc {
namespace {

TEST(FocOpenLoop, RampsAndTurnsExactly) {
  RegisterFile registers;
  registers.set(field("OPENLOOP_ACCELERATION"), 1234);
  registers.set(field("OPENLOOP_VELOCITY_TARGET"), 900);
  OpenLoopGenerator generator;
  generator.configure(registers);
  double turned = 0.0;
  for (int k = 1; k <= 50'000; ++k) {
    generator.step(4000);
    const double exact = std::min(900.0, std::floor(1234.0 * k * 40e-6 + 1e-9));
    ASSERT_EQ(generator.velocity(), exact);
    turned += exact / 60.0 * 40e-6;
    ASSERT_LE(std::fabs(std::remainder(generator.phi() - turned * 65536.0, 65536.0)), 1.001);
  }
}

TEST(FocOpenLoop, DirectionBitAndSignTurnBackwards) {
  RegisterFile registers;
  registers.set(field("OPENLOOP_VELOCITY_TARGET"), -60);
  registers.set(field("OPENLOOP_ACCELERATION"), 0xFFFFF);
  OpenLoopGenerator generator;
  generator.configure(registers);
  for (int k = 0; k < 2500; ++k) {
    generator.step(4000);
  }
  EXPECT_NEAR(static_cast<std::int16_t>(generator.phi()), -6554, 30);
  registers.set(field("OPENLOOP_PHI_DIRECTION"), 1);
  generator.configure(registers);
  for (int k = 0; k < 2500; ++k) {
    generator.step(4000);
  }
  EXPECT_NEAR(static_cast<std::int16_t>(generator.phi()), 0, 30);
}

TEST(FocVelocityMeter, AtAFixedRateIsWithinOneRpmAtAnyPwmFrequency) {
  for (const std::int32_t ticks : {1000, 2000, 4000, 5000, 50'000}) {
    for (const double rpm : {0.0, 1.0, 17.3, 1500.0, -3000.0, 9000.0}) {
      VelocityMeter meter;
      meter.configure(MeterKind::fixed_rate, 1);
      double exact = 0.0;
      std::int64_t shown = 0;
      for (int k = 0; k < 4'000'000 / ticks; ++k) {
        exact += rpm / 60.0 * ticks * 1e-8 * 65536.0;
        const auto angle = static_cast<std::int64_t>(std::floor(exact));
        const std::int32_t velocity = meter.step(static_cast<std::int32_t>(angle - shown), ticks);
        shown = angle;
        if (k * ticks > 200'000) {
          ASSERT_NEAR(velocity, rpm, 2.0) << ticks << ' ' << k;
        }
      }
    }
  }
}

TEST(FocVelocityMeter, ByTimeDifferenceIsRightForSlowEncoders) {
  VelocityMeter meter;
  meter.configure(MeterKind::time_difference, 60);
  // 1000 positions per revolution at 7 rpm: one every 8.57 ms.
  double exact = 0.0;
  std::int64_t shown = 0;
  for (int k = 0; k < 100'000; ++k) {
    exact += 7.0 / 60.0 * 40e-6 * 1000.0;
    const std::int64_t angle = static_cast<std::int64_t>(exact) * 65536 / 1000;
    const std::int32_t velocity = meter.step(static_cast<std::int32_t>(angle - shown), 4000);
    shown = angle;
    if (k > 1000) {
      ASSERT_NEAR(velocity, 7.0, 1.0);
    }
  }
  for (int k = 0; k < 2600; ++k) {
    meter.step(0, 4000);
  }
  EXPECT_EQ(meter.velocity(), 0);
}

TEST(FocSelectors, ChooseTheAnglesForCommutationVelocityAndPosition) {
  FocBlock block;
  block.set(field("N_POLE_PAIRS"), 4);
  block.set(field("ABN_DECODER_PPR"), 4096);
  block.set(field("ABN_2_DECODER_PPR"), 1000);
  block.set(field("PHI_E_EXT"), -777);
  Inputs inputs;
  inputs.halls = 2;
  block.step(inputs);
  inputs.abn.count = 100;
  inputs.abn_2.count = 10;
  block.step(inputs);
  const auto phi_e = [&](int selection) {
    block.set(field("PHI_E_SELECTION"), selection);
    block.step(inputs);
    return block.get(field("PHI_E"));
  };
  EXPECT_EQ(phi_e(0), 0);
  EXPECT_EQ(phi_e(1), -777);
  EXPECT_EQ(phi_e(3), 6400);
  EXPECT_EQ(phi_e(5), 21845);
  EXPECT_EQ(phi_e(10), 0);  // the second encoder does not commutate
  EXPECT_EQ(phi_e(9), 0);
  block.set(field("POSITION_SELECTION"), 10);
  block.write(0x6B, 0);
  inputs.abn_2.count += 2500;  // 2.5 revolutions, in steps that do not alias
  for (int k = 0; k < 10; ++k) {
    inputs.abn_2.count += 250 - (k == 0 ? 2500 : 0);
    block.step(inputs);
  }
  EXPECT_NEAR(block.get(field("PID_POSITION_ACTUAL")), 2.5 * 65536.0, 70.0);
  block.write(0x6B, static_cast<std::uint32_t>(-5));
  EXPECT_EQ(block.get(field("PID_POSITION_ACTUAL")), -5);
  // 600 rpm of the first encoder: 40.96 counts per 40 us x 25 = 1 ms.
  block.set(field("VELOCITY_SELECTION"), 9);
  double count = static_cast<double>(inputs.abn.count);
  for (int k = 0; k < 2500; ++k) {
    count += 600.0 / 60.0 * 4096.0 * 40e-6;
    inputs.abn.count = static_cast<std::int64_t>(count);
    block.step(inputs);
  }
  EXPECT_NEAR(block.get(field("PID_VELOCITY_ACTUAL")), 600, 16);  // one count is 16 rpm
}

}  // namespace
}  // namespace stator::control::foc
