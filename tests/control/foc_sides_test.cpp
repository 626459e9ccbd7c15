// DC and two-phase motors, status flags and single gates of the TMC8670's FOC block at their
// limits.
#include <array>
#include <cstdint>

#include <gtest/gtest.h>

#include "foc_test_block.hpp"
#include "stator/control/foc/foc_block.hpp"
#include "stator/control/foc/pwm_engine.hpp"

namespace stator::control::foc {
namespace {

TEST(FocDirectCurrent, HasNoVoltageOfTheFluxAxis) {
  FocBlock block = block_in(1);
  block.set(field("MOTOR_TYPE"), 1);
  block.set(field("PID_FLUX_TARGET"), 1'000);
  block.set(field("PID_TORQUE_TARGET"), 2'000);
  block.step(with_currents(0, 0));
  EXPECT_EQ(block.get(field("FOC_UD")), 0);
  EXPECT_EQ(block.get(field("FOC_UQ")), 2'000);
  EXPECT_EQ(block.get(field("FOC_UA")), 2'000) << "the winding's voltage";
  EXPECT_EQ(block.get(field("FOC_UB")), 0);
}

TEST(FocTwoPhase, ShowsTheVoltagesOfItsWindingsAsUxAndWy) {
  FocBlock block = block_in(8);
  block.set(field("MOTOR_TYPE"), 2);
  block.set(field("UD_EXT"), 4'000);
  block.set(field("UQ_EXT"), 3'000);
  block.step(with_currents(0, 0));
  EXPECT_EQ(block.get(field("FOC_UUX")), 4'000);
  EXPECT_EQ(block.get(field("FOC_UV")), 0);
  EXPECT_EQ(block.get(field("FOC_UWY")), 3'000);
}

TEST(FocFlags, VoltageWithinTheCircleIsNotFlaggedAsLimited) {
  FocBlock block = block_in(8);
  block.set(field("UD_EXT"), 4'000);
  block.set(field("UQ_EXT"), 3'000);
  block.step(with_currents(0, 0));
  EXPECT_EQ(block.get(field("IPARK_CIRLIM_LIMIT_U_D")), 0);
  EXPECT_EQ(block.get(field("IPARK_CIRLIM_LIMIT_U_Q")), 0);
  EXPECT_EQ(block.get(field("IPARK_CIRLIM_LIMIT_U_R")), 0);
}

TEST(FocFlags, EachReferenceSwitchHasAFlagOfItsOwn) {
  for (const int active : {0, 1, 2, 3}) {
    FocBlock block = block_in(8);
    Inputs inputs;  // open inputs read high: not active
    block.set(field("REF_SWITCH_CONFIG"), 0x70);
    block.step(inputs);
    block.write(0x7C, 0);
    inputs.home_switch = active != 1;
    inputs.left_switch = active != 2;
    inputs.right_switch = active != 3;
    block.step(inputs);
    EXPECT_EQ(block.get(field("REF_SW_H")), active == 1 ? 1 : 0) << active;
    EXPECT_EQ(block.get(field("REF_SW_L")), active == 2 ? 1 : 0) << active;
    EXPECT_EQ(block.get(field("REF_SW_R")), active == 3 ? 1 : 0) << active;
  }
}

TEST(PwmGates, HighSidesOnLeavesNoTickToALowSide) {
  // One tick of both is a short circuit of the supply.
  PwmPeriod pwm;
  pwm.half_bridges = 3;
  pwm.chopper = Chopper::high_sides_on;
  const PwmEngine engine;
  for (std::int32_t tick = 0; tick < pwm.period; ++tick) {
    ASSERT_EQ(engine.gate_levels(pwm, true, tick), 0x2AU) << tick;
  }
}

TEST(PwmGates, AFullOnTimeLeavesTheLowSideOffForTheWholePeriod) {
  PwmPeriod pwm;
  pwm.half_bridges = 1;
  pwm.on_time = {pwm.period, 0, 0, 0};
  for (const Chopper chopper : {Chopper::centred, Chopper::low_side, Chopper::high_side}) {
    pwm.chopper = chopper;
    const GateTimes times = PwmEngine::gate_times(pwm, 0);
    EXPECT_EQ(times.low_off, 0);
    EXPECT_EQ(times.low_on, pwm.period) << "no edge, hence no pause beyond the period";
  }
}

}  // namespace
}  // namespace stator::control::foc
