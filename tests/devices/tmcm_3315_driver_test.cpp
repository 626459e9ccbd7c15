// StallGuard2, CoolStep, StealthChop and chopper of the module, with its simulated motors.

#include <algorithm>
#include <cmath>
#include <vector>

#include "devices/tmcm_3315_driver_module.hpp"

namespace stator::devices {
namespace {

constexpr std::int32_t kTwoRevolutions = 102'400;  // pps
constexpr double kTorqueConstant = 50 * 4.62e-3;   // N m/A of the default motor
/// Peak of the run current at 2003h = 128.
constexpr double kRunCurrent = 17.0 / 32.0 * 3.0;
constexpr double kHoldingTorque = kTorqueConstant * kRunCurrent;

TEST_F(DriverModule, TheLoadValueFallsLinearlyWithLoadAndNearlyToZeroAtPullOut) {
  go_operational();
  write<std::uint8_t>(0x209D, 1);
  run_at(kTwoRevolutions);
  const double unloaded = stall_guard();
  EXPECT_NEAR(unloaded, 280.0, 20.0);
  for (const double share : {0.3, 0.6, 0.9}) {
    load_slowly(-share * kHoldingTorque);
    double sum = 0.0;
    for (int n = 0; n < 20; ++n) {
      bus_->pass(20_ms);
      sum += stall_guard();
    }
    EXPECT_NEAR(sum / 20.0, unloaded - 100.0 * kTorqueConstant * share * 4.0 * base::kPi,
                0.04 * unloaded)
        << share;
  }
}

TEST_F(DriverModule, TheLoadValueIsZeroWhileTheMotorStands) {
  go_operational();
  run_at(kTwoRevolutions);
  EXPECT_GT(stall_guard(), 100);
  write<std::int32_t>(0x60FF, 0);
  bus_->pass(1_s);
  EXPECT_EQ(stall_guard(), 0);
}

TEST_F(DriverModule, TheThresholdShiftsTheLoadValue) {
  go_operational();
  run_at(kTwoRevolutions);
  const int neutral = stall_guard();
  write<std::int8_t>(0x209E, 20);
  bus_->pass(50_ms);
  EXPECT_NEAR(stall_guard(), neutral + 160, 20) << "higher is less sensitive";
  write<std::int8_t>(0x209E, -20);
  bus_->pass(50_ms);
  EXPECT_NEAR(stall_guard(), neutral - 160, 20);
}

TEST_F(DriverModule, AStallStopsTheMotorAtOnceBeforeStepsAreLostAndIsTold) {
  go_operational();
  write<std::int8_t>(0x209E, -10);
  write<std::uint32_t>(0x20A4, 51'200);
  run_at(kTwoRevolutions);
  ASSERT_EQ(statusword() & 0x4000, 0x4000);
  load_slowly(-0.5 * kHoldingTorque);
  EXPECT_EQ(statusword() & 0x4000, 0x4000) << "half of what it holds is no stall";
  for (int n = 0; n < 1000 && error_register() == 0; ++n) {
    set_input("axis0.load_torque", -(0.5 + 0.0005 * n) * kHoldingTorque);
    bus_->pass(2_ms);
  }
  EXPECT_EQ(bus_->take_emergencies(), std::vector<Emergency>({{0x30, 0x32, 0x21, 0, 0, 0, 0, 0}}));
  EXPECT_EQ(statusword() & 0x486F, 0x0027) << "stands, enabled, no fault, no limit";
  EXPECT_EQ(error_register(), 0x21);
  set_input("axis0.load_torque", 0.0);
  bus_->pass(200_ms);
  EXPECT_NEAR(signal("axis0.following_error"), 0.0, 16.0) << "no step lost";
  write<std::int32_t>(0x60FF, kTwoRevolutions);
  bus_->pass(500_ms);
  EXPECT_EQ(statusword() & 0x4000, 0x4000) << "a new target moves it again";
  EXPECT_EQ(error_register(), 0);
}

TEST_F(DriverModule, BelowItsSpeedOrWithZeroNoStallStops) {
  for (const std::uint32_t speed : {0U, 200'000U}) {
    go_operational();
    write<std::uint32_t>(0x20A4, speed);
    run_at(kTwoRevolutions);
    set_input("axis0.load_torque", -2.0);
    bus_->pass(500_ms);
    EXPECT_EQ(stall_guard(), 0);
    EXPECT_EQ(statusword() & 0x4000, 0x4000) << speed;
    EXPECT_TRUE(bus_->take_emergencies().empty());
    control(0, 0);
    set_input("axis0.load_torque", 0.0);
    bus_->pass(500_ms);
  }
}

TEST_F(DriverModule, AfterAStallCyclicTargetsAreIgnoredUntilHaltOrANewEnable) {
  bus_->bring_to(AlState::pre_operational);
  write<std::uint32_t>(0x20A4, 51'200);
  write<std::int8_t>(0x6060, 9);
  bus_->bring_to(AlState::operational);
  const auto send = [&](std::uint16_t controlword, std::int32_t velocity, int cycles) {
    base::store_le(bus_->outputs, 0, controlword);
    base::store_le(bus_->outputs, 6, velocity);
    for (int n = 0; n < cycles; ++n) {
      bus_->exchange();
      bus_->pass(980_us);
    }
    return base::load_le<std::uint16_t>(bus_->inputs, 0);
  };
  for (const int controlword : {6, 7, 15}) {
    send(static_cast<std::uint16_t>(controlword), 0, 2);
  }
  for (int n = 0; n <= 200; ++n) {
    send(15, n * kTwoRevolutions / 200, 1);
  }
  ASSERT_EQ(send(15, kTwoRevolutions, 100) & 0x5000, 0x5000);
  set_input("axis0.load_torque", -2.0);
  send(15, kTwoRevolutions, 300);
  EXPECT_EQ(send(15, kTwoRevolutions, 100) & 0x5000, 0) << "stands, target ignored";
  set_input("axis0.load_torque", 0.0);
  send(0x010F, 0, 5);
  EXPECT_EQ(send(15, 0, 5) & 0x1000, 0x1000);
}

/// CoolStep as one would set it for the default motor at 2 rev/s.
void set_cool_step(tests::TestBus& bus) {
  EXPECT_EQ(bus.download<std::uint8_t>(0x209D, 0, 1), 0U);  // filter
  EXPECT_EQ(bus.download<std::uint8_t>(0x209C, 0, 3), 0U);  // below 96: more current
  EXPECT_EQ(bus.download<std::uint8_t>(0x209A, 0, 2), 0U);  // above 192: less
  EXPECT_EQ(bus.download<std::uint8_t>(0x2099, 0, 2), 0U);  // 2 measurements per step down
  EXPECT_EQ(bus.download<std::uint8_t>(0x209B, 0, 2), 0U);  // 4 steps up
  EXPECT_EQ(bus.download<std::uint32_t>(0x20A5, 0, 51'200), 0U);
}

TEST_F(DriverModule, CoolStepSavesCurrentAtLightLoadAndRestoresItUnderLoadWithoutLosingSteps) {
  go_operational();
  set_cool_step(*bus_);
  run_at(kTwoRevolutions);
  bus_->pass(1_s);
  EXPECT_NEAR(signal("axis0.current_scale"), 9.0 / 32.0, 0.005) << "half of step 16 is 8";
  load_slowly(-0.7 * kHoldingTorque);
  bus_->pass(500_ms);
  EXPECT_GT(signal("axis0.current_scale"), 15.0 / 32.0);
  EXPECT_LT(stall_guard(), 192);
  load_slowly(0.0);
  bus_->pass(1_s);
  EXPECT_NEAR(signal("axis0.current_scale"), 9.0 / 32.0, 0.005);
  write<std::int32_t>(0x60FF, 0);
  bus_->pass(1_s);
  EXPECT_NEAR(signal("axis0.following_error"), 0.0, 16.0);
}

TEST_F(DriverModule, CoolStepSavesThreeQuartersOfTheCurrentAtMostAndOnlyAboveItsSpeed) {
  go_operational();
  write<std::uint8_t>(0x2003, 255);
  write<std::uint8_t>(0x2098, 1);
  set_cool_step(*bus_);
  run_at(kTwoRevolutions);
  bus_->pass(2_s);
  const double saved = signal("axis0.current_scale");
  EXPECT_NEAR(saved, 8.0 / 32.0, 0.005) << "a quarter of step 31 is 7";
  write<std::uint32_t>(0x20A5, kTwoRevolutions);
  bus_->pass(20_ms);
  EXPECT_NEAR(signal("axis0.current_scale"), 1.0, 0.005) << "not above the threshold speed";
  write<std::uint32_t>(0x20A5, 0);
  bus_->pass(2_s);
  EXPECT_NEAR(signal("axis0.current_scale"), saved, 0.005) << "0: at any speed";
  write<std::uint8_t>(0x209C, 0);
  bus_->pass(20_ms);
  EXPECT_NEAR(signal("axis0.current_scale"), 1.0, 0.005) << "209Ch = 0 switches it off";
}

TEST_F(DriverModule, BoostCurrentIsNotReducedByCoolStep) {
  go_operational();
  write<std::uint8_t>(0x204E, 255);
  set_cool_step(*bus_);
  run_at(kTwoRevolutions);
  bus_->pass(1_s);
  ASSERT_NEAR(signal("axis0.current_scale"), 9.0 / 32.0, 0.005);
  write<std::int32_t>(0x60FF, 2 * kTwoRevolutions);
  bus_->pass(100_ms);
  EXPECT_NEAR(signal("axis0.current_scale"), 1.0, 0.005);
}

TEST_F(DriverModule, StealthChopDrivesWithAVoltageWhoseCurrentFollowsTheImpedance) {
  go_operational();
  write<std::uint8_t>(0x2003, 255);
  write<std::uint16_t>(0x2089, 65'535);
  write<std::uint8_t>(0x20B2, 10);  // 10 / 255 of 24 V
  write<std::uint8_t>(0x20B1, 19);
  write<std::uint32_t>(0x20B0, 60'000);
  enable(0, 3);
  bus_->pass(300_ms);
  const double resistance = device_->axis(0).plant().resistance();
  EXPECT_NEAR(signal("axis0.coil_current_a"), 10.0 / 255.0 * 24.0 / resistance, 0.01);
  EXPECT_NEAR(signal("axis0.coil_current_b"), 0.0, 0.01);
  EXPECT_NEAR(signal("axis0.chopper_frequency"), 31'250.0, 0.1);
}

TEST_F(DriverModule, StealthChopWorksBelowItsSpeedOnlyAndMeasuresNoLoad) {
  go_operational();
  write<std::uint8_t>(0x20B2, 100);
  write<std::uint8_t>(0x20B1, 19);
  write<std::uint32_t>(0x20B0, 60'000);
  write<std::uint32_t>(0x20A4, 1000);
  run_at(51'200);
  EXPECT_EQ(stall_guard(), 0);
  EXPECT_EQ(statusword() & 0x4000, 0x4000) << "no stop on stall";
  EXPECT_NEAR(signal("axis0.chopper_frequency"), 31'250.0, 0.1);
  write<std::int32_t>(0x60FF, kTwoRevolutions);
  bus_->pass(1_s);
  EXPECT_GT(stall_guard(), 200) << "back to the current chopper";
  EXPECT_GT(std::fabs(signal("axis0.chopper_frequency") - 31'250.0), 100.0);
  EXPECT_NEAR(signal("axis0.following_error"), 0.0, 256.0) << "and no step was lost";
  write<std::int32_t>(0x60FF, 51'200);
  bus_->pass(1_s);
  write<std::uint8_t>(0x20B1, 0);
  bus_->pass(100_ms);
  EXPECT_GT(stall_guard(), 50) << "gradient 0 switches it off";
}

TEST_F(DriverModule, ChopperObjectsShapeFrequencyAndRipple) {
  go_operational();
  enable(0, 1);
  bus_->pass(100_ms);
  const auto frequency = [&] { return signal("axis0.chopper_frequency"); };
  const auto ripple = [&] { return signal("axis0.current_ripple"); };
  const auto change = [&](std::uint16_t index, auto value) {
    write(index, value);
    bus_->pass(2_ms);
  };
  const double usual = frequency();
  EXPECT_GT(usual, 5e3);
  EXPECT_LT(usual, 100e3);
  change(0x2097, std::uint8_t{15});
  EXPECT_LT(frequency(), usual);
  change(0x2097, std::uint8_t{5});
  EXPECT_NEAR(frequency(), usual, 1.0);

  double before = ripple();
  change(0x2095, std::int8_t{6});
  EXPECT_GT(ripple(), before) << "hysteresis end";
  before = ripple();
  change(0x2096, std::uint8_t{8});
  EXPECT_GT(ripple(), before) << "hysteresis start";
  before = ripple();
  change(0x2094, std::uint8_t{3});
  EXPECT_GT(ripple(), before) << "slower decrement";
  change(0x2095, std::int8_t{-3});
  change(0x2096, std::uint8_t{0});
  before = ripple();
  change(0x2092, std::uint8_t{3});
  EXPECT_GT(ripple(), before) << "blank time";
  before = frequency();
  change(0x2093, std::uint8_t{1});
  EXPECT_NE(frequency(), before) << "constant off time";
  change(0x2097, std::uint8_t{0});
  EXPECT_EQ(frequency(), 0.0) << "off";
}

TEST_F(DriverModule, BothTemperaturesRiseUnderCurrent) {
  go_operational();
  write<std::uint8_t>(0x2003, 255);
  write<std::uint16_t>(0x2089, 65'535);
  enable(0, 1);
  bus_->pass(20_s);
  EXPECT_GT(signal("axis0.winding_temperature"), 27.0);
  EXPECT_GT(signal("axis0.driver_temperature"), 28.0);
  EXPECT_EQ(signal("axis1.winding_temperature"), 25.0);
}

TEST_F(DriverModule, TheHomeOffsetDisplayShowsTheOffsetInUse) {
  go_operational();
  EXPECT_EQ(bus_->upload<std::int32_t>(0x2100), 0);
  write<std::int32_t>(0x607C, -1234);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x2100), -1234);
}

}  // namespace
}  // namespace stator::devices
