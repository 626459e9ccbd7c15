// Pins of the TMC8670's FOC block: steps, analog and PWM targets, brake chopper, switches, status
// flags.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "control/foc_test_block.hpp"
#include "stator/control/foc/peripherals.hpp"

namespace stator::control::foc {
namespace {

TEST(FocBlock, StepPulsesMoveThePositionTarget) {
  FocBlock block = block_in(3);
  block.set(field("STEP_WIDTH"), 256);
  Inputs inputs;
  inputs.steps = 10;
  block.step(inputs);
  EXPECT_EQ(block.get(field("PID_POSITION_TARGET")), 2560);
  inputs.steps = 13;
  inputs.direction = true;
  block.step(inputs);
  EXPECT_EQ(block.get(field("PID_POSITION_TARGET")), 2560 - 768);
  block.set(field("PID_TORQUE_OFFSET"), 1);  // any other write leaves it alone
  block.step(inputs);
  EXPECT_EQ(block.get(field("PIDIN_TARGET_POSITION")), 2560 - 768);
}

TEST(FocBlock, AnalogPinGivesTorqueVelocityAndPosition) {
  for (const auto& [mode, shown] : {std::pair{10, field("PIDIN_TARGET_TORQUE")},
                                    {11, field("PIDIN_TARGET_VELOCITY")},
                                    {12, field("PIDIN_TARGET_POSITION")}}) {
    FocBlock block = block_in(mode);
    block.set(field("SINGLE_PIN_IF_OFFSET"), -32768);
    block.set(field("SINGLE_PIN_IF_SCALE"), 128);
    Inputs inputs;
    inputs.delta_sigma_a.general_a = 32768 + 3000;
    block.step(inputs);
    EXPECT_EQ(block.get(shown), 1500) << mode;
    EXPECT_EQ(block.get(field("SINGLE_PIN_IF_STATUS")), 1);
  }
}

TEST(FocBlock, BadPwmInputStopsTorqueAndVelocityAndHoldsThePosition) {
  for (const auto& [mode, shown] : {std::pair{13, field("PIDIN_TARGET_TORQUE")},
                                    {14, field("PIDIN_TARGET_VELOCITY")},
                                    {15, field("PIDIN_TARGET_POSITION")}}) {
    FocBlock block = block_in(mode);
    block.set(field("SINGLE_PIN_IF_SCALE"), 64);
    block.set(field("SINGLE_PIN_IF_CFG"), 1);
    Inputs inputs;
    inputs.pwm_in = {.period = 100'000, .high = 25'000};  // 1 kHz, 25 %
    block.step(inputs);
    EXPECT_EQ(block.get(shown), 4096) << mode;
    EXPECT_EQ(block.get(field("SINGLE_PIN_IF_PWM_DUTY_CYCLE")), 16384);
    inputs.pwm_in = {.period = 4'000, .high = 2'000};  // 25 kHz is out of range
    block.step(inputs);
    EXPECT_EQ(block.get(shown), mode == 15 ? 4096 : 0) << mode;
    EXPECT_EQ(block.get(field("SINGLE_PIN_IF_STATUS")), 0);
    block.set(field("SINGLE_PIN_IF_CFG"), 0);  // not neglected
    block.step(inputs);
    EXPECT_EQ(block.get(shown), 8192) << mode;
    inputs.pwm_in = {};
    block.step(inputs);
    EXPECT_EQ(block.get(shown), mode == 15 ? 8192 : 0) << mode;
  }
}

TEST(FocBlock, NoiseModesExciteTheirOwnTarget) {
  for (const auto& [mode, shown] : {std::pair{4, field("PIDIN_TARGET_FLUX")},
                                    {5, field("PIDIN_TARGET_TORQUE")},
                                    {6, field("PIDIN_TARGET_VELOCITY")},
                                    {7, field("PIDIN_TARGET_POSITION")}}) {
    FocBlock block = block_in(mode);
    block.set(field("PRBS_AMPLITUDE"), 300);
    block.set(field("PRBS_DOWN_SAMPLING_RATIO"), 1);
    std::int64_t sum = 0;
    int changes = 0;
    int before = 0;
    for (int k = 0; k < 2 * 32767; ++k) {
      block.step(with_currents(0, 0));
      const int now = block.get(shown);
      ASSERT_EQ(std::abs(now), 300) << mode;
      sum += now;
      changes += now != before && k % 2 == 1 && k > 1 ? 1 : 0;
      before = now;
    }
    EXPECT_LE(std::abs(sum), 2 * 300 + 300);  // one more of one kind in 2^15 - 1
    EXPECT_TRUE(changes == 0 || changes > 16'000) << changes;
  }
}

TEST(FocNoise, RepeatsAfterTwoToTheFifteenthLessOneSteps) {
  PseudoRandomSequence noise;
  noise.configure(1, 0);
  std::vector<std::int32_t> once;
  for (int k = 0; k < 32767; ++k) {
    once.push_back(noise.step());
  }
  for (int k = 0; k < 32767; ++k) {
    ASSERT_EQ(noise.step(), once[static_cast<std::size_t>(k)]);
  }
  EXPECT_EQ(std::count(once.begin(), once.end(), 1), 16384);
}

TEST(FocBrakeChopper, SwitchesWithHysteresisOnTheRawSupply) {
  FocBlock block = block_in(0);
  const auto at = [&](std::uint16_t supply) {
    Inputs inputs;
    inputs.delta_sigma_a.motor_supply = supply;
    return block.step(inputs).brake_chopper;
  };
  EXPECT_FALSE(at(65535));  // off after power-on
  block.write(0x75, 40000U << 16U | 38000U);
  EXPECT_FALSE(at(39999));
  EXPECT_TRUE(at(40000));
  EXPECT_TRUE(at(39000));
  EXPECT_TRUE(at(38000));
  EXPECT_FALSE(at(37999));
  EXPECT_FALSE(at(39000));
  EXPECT_TRUE(at(50000));
  EXPECT_EQ(block.get(field("ADC_VM_RAW")), 50000);
}

TEST(FocReferenceSwitches, AreShownAndKeepPositionsButStopNothing) {
  FocBlock block = block_in(8);
  block.set(field("UQ_EXT"), 5000);
  block.set(field("REF_SWITCH_CONFIG"), 0x70);
  block.write(0x6B, 1234);
  Inputs inputs;  // open inputs read high: not active
  block.step(inputs);
  EXPECT_EQ(block.get(field("REF_SWITCH_STATUS")), 0);
  EXPECT_EQ(block.get(field("REF_SW_H_RAW")), 1);
  block.write(0x7C, 0);
  inputs.home_switch = false;
  block.step(inputs);
  EXPECT_EQ(block.get(field("REF_SWITCH_STATUS")), 0x11);
  EXPECT_EQ(block.get(field("HOME_POSITION")), 1234);
  EXPECT_EQ(block.get(field("REF_SW_H")), 1);
  EXPECT_EQ(block.get(field("REF_SW_L")), 0);
  EXPECT_EQ(block.get(field("REF_SW_H_RAW")), 0);
  inputs.home_switch = true;
  inputs.left_switch = false;
  block.write(0x6B, 500);
  block.step(inputs);
  inputs.right_switch = false;
  block.write(0x6B, 600);
  block.step(inputs);
  EXPECT_EQ(block.get(field("LEFT_POSITION")), 500);
  EXPECT_EQ(block.get(field("RIGHT_POSITION")), 600);
  EXPECT_EQ(block.get(field("HOME_POSITION")), 1234);
  EXPECT_EQ(block.get(field("FOC_UQ_LIMITED")), 5000);
  block.set(field("REF_SWITCH_CONFIG"), 0x07);  // active high
  block.step(inputs);
  EXPECT_EQ(block.get(field("REF_SWITCH_STATUS")) & 7, 1);
}

TEST(FocStatusFlags, StayUntilAZeroIsWrittenAndDriveThePinByTheirMask) {
  FocBlock block = block_in(8);
  block.set(field("UQ_EXT"), 30000);
  block.step(with_currents(0, 0));
  block.set(field("UQ_EXT"), 0);
  block.step(with_currents(0, 0));
  EXPECT_EQ(block.get(field("IPARK_CIRLIM_LIMIT_U_Q")), 1);
  EXPECT_FALSE(block.outputs().status);
  block.write(0x7D, mask(field("IPARK_CIRLIM_LIMIT_U_Q")));
  EXPECT_TRUE(block.step(with_currents(0, 0)).status);
  block.write(0x7C, ~mask(field("IPARK_CIRLIM_LIMIT_U_Q")));
  EXPECT_FALSE(block.step(with_currents(0, 0)).status);
  EXPECT_EQ(block.get(field("IPARK_CIRLIM_LIMIT_U_Q")), 0);
  EXPECT_EQ(block.get(field("IPARK_CIRLIM_LIMIT_U_R")), 1);
}

TEST(FocBlock, EnableOutFollowsTheEnableOfTheDrive) {
  FocBlock block = block_in(0);
  Inputs inputs;
  EXPECT_TRUE(block.step(inputs).enable);
  inputs.enable = false;
  EXPECT_FALSE(block.step(inputs).enable);
  EXPECT_EQ(block.get(field("ENABLE_IN_RAW")), 0);
  EXPECT_EQ(block.read(0x77), 0U);
}

TEST(FocBlock, GateOutputsShowAtTheirRegister) {
  FocBlock block = block_in(8);
  block.step({});
  block.step({});
  EXPECT_EQ(block.read(0x77), 0x15U);  // a centred period begins with the low sides
  block.set(field("PWM_POLARITIES_0"), 1);
  EXPECT_EQ(block.read(0x77), 0x40U);
}

TEST(FocBlock, InputLevelsShowAtTheirRegister) {
  FocBlock block = block_in(0);
  Inputs inputs;
  inputs.halls = 5;
  block.step(inputs);
  block.step(inputs);
  EXPECT_EQ(block.get(field("HALL_UX_OF_HALL_RAW")), 1);
  EXPECT_EQ(block.get(field("HALL_V_OF_HALL_RAW")), 0);
  EXPECT_EQ(block.get(field("HALL_WY_FILT")), 1);
  inputs.abn.count = 2;
  inputs.abn.n = true;
  inputs.abn_2.count = 3;
  inputs.pwm_in.level = true;
  inputs.direction = true;
  inputs.general_inputs = 0xA5;
  block.step(inputs);
  EXPECT_EQ(block.get(field("A_OF_ABN_RAW")), 1);
  EXPECT_EQ(block.get(field("B_OF_ABN_RAW")), 1);
  EXPECT_EQ(block.get(field("N_OF_ABN_RAW")), 1);
  EXPECT_EQ(block.get(field("A_OF_ABN_2_RAW")), 0);
  EXPECT_EQ(block.get(field("B_OF_ABN_2_RAW")), 1);
  EXPECT_EQ(block.get(field("PWM_IN_RAW")), 1);
  EXPECT_EQ(block.get(field("DIR_OF_DIRSTP_RAW")), 1);
  EXPECT_EQ(block.get(field("GPI")), 0xA5);
}

TEST(FocBlock, IsAValueThatGoesOnTheSameWayFromACopy) {
  FocBlock block = block_in(3);
  block.set(field("PID_POSITION_TARGET"), 100'000);
  block.set(field("PID_VELOCITY_I"), 1000);
  Inputs inputs = with_currents(100, 200);
  for (int k = 0; k < 500; ++k) {
    inputs.abn.count += k % 7;
    block.step(inputs);
  }
  FocBlock copy = block;
  for (int k = 0; k < 500; ++k) {
    inputs.abn.count += k % 5;
    ASSERT_EQ(block.step(inputs).pwm, copy.step(inputs).pwm);
  }
  for (unsigned address = 0; address < 128; ++address) {
    EXPECT_EQ(block.read(static_cast<std::uint8_t>(address)),
              copy.read(static_cast<std::uint8_t>(address)));
  }
}

}  // namespace
}  // namespace stator::control::foc
