// Closed loop: the document's example, overload, current, field weakening, start and end.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "devices/closed_loop_module.hpp"
#include "stator/base/event.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::devices {
namespace {

/// Microsteps by which the detent torque, 0.03 Nm, pulls a rotor that holds itself with a fifth of
/// 1.03 A, some 0.05 Nm: load angle control is no position controller.
constexpr double kDetent = 40.0;

TEST_F(ClosedLoopModule, TheExampleRunsAsWritten) {
  go_operational();
  write_example();
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x2120), 0);
  enable(0, 1);
  EXPECT_EQ(statusword() & 0x006F, 0x0027);
  write<std::uint8_t>(0x2020, 1);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x2120), 0) << "initialising";
  await_initialisation();
  bus_->pass(300_ms);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x2033), 50) << "no load: 2029h";
  EXPECT_NEAR(signal("axis0.coil_current_a"), 11.0 / 32.0 * 3.0 * 50.0 / 255.0, 2e-3);

  set_profile(0, 51'200, 512'000);
  start_move(0, 500'000);
  bus_->pass(11_s);
  EXPECT_EQ(statusword() & 0x0400, 0x0400);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), 500'000);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x6064), 500'000, kDetent);
  EXPECT_NEAR(shaft_microsteps(), 500'000.0, kDetent);
}

/// Holding torque at the example's 1.03 A: 0.238 Nm. Twice that for 20 ms.
constexpr double kTwicePullOut = -2.0 * 0.231 * 3.0 * 11.0 / 32.0;

TEST_F(ClosedLoopModule, AnOverloadOfTwicePullOutLosesNoStepAndIsCaughtUp) {
  go_operational();
  start_closed_loop();
  set_profile(0, 51'200, 512'000);
  start_move(0, 256'000);
  bus_->pass(1_s);
  load(kTwicePullOut);
  bus_->pass(20_ms);
  EXPECT_GT(signal("axis0.following_error"), 5000.0) << "the shaft goes with the load";
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x2033), 255);
  load(0.0);
  bus_->pass(60_ms);
  double fastest = 0.0;
  while (signal("axis0.following_error") > 1000.0) {
    bus_->pass(5_ms);
    fastest = std::max(fastest, static_cast<double>(bus_->upload<std::int32_t>(0x606C)));
  }
  EXPECT_GT(fastest, 140'000.0) << "planned 51200 and catching up";
  EXPECT_LT(fastest, 151'200.0 * 1.01) << "planned + 202Fh";
  bus_->pass(200_ms);
  EXPECT_NEAR(signal("axis0.following_error"), 0.0, 100.0) << "before the move has ended";
  EXPECT_EQ(statusword() & 0x4400, 0x4000);
  bus_->pass(5_s);
  EXPECT_NEAR(shaft_microsteps(), 256'000.0, kDetent);
}

TEST_F(ClosedLoopModule, TheSameOverloadInOpenLoopLosesSteps) {
  go_operational();
  write_example();
  enable(0, 1);
  set_profile(0, 51'200, 512'000);
  start_move(0, 256'000);
  bus_->pass(1_s);
  load(kTwicePullOut);
  bus_->pass(20_ms);
  load(0.0);
  bus_->pass(8_s);
  EXPECT_GT(256'000.0 - shaft_microsteps(), 1000.0);
}

TEST_F(ClosedLoopModule, CurrentFallsAtLightLoadAndRisesUnderLoad) {
  go_operational();
  start_closed_loop();
  bus_->pass(300_ms);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x2033), 50);
  load(-0.1);
  bus_->pass(300_ms);
  // Torque = Kt I(scale) sin(angle): 0.231 * 1.031 * s * sin(a), s = 50 + 205 a / 255.
  const auto& loop = device_->axis(0).axis().closed_loop();
  const double angle = loop.load_angle() * base::kTwoPi / 1024.0;
  const double scale = 50.0 + 205.0 * loop.load_angle() / 255.0;
  EXPECT_NEAR(bus_->upload<std::uint8_t>(0x2033), scale, 6.0) << "a count of the encoder is 4";
  EXPECT_NEAR(0.231 * 11.0 / 32.0 * 3.0 * scale / 255.0 * std::sin(angle), 0.1, 0.035)
      << "detent torque is 0.03";
  load(0.0);
  bus_->pass(10_ms);
  EXPECT_GT(bus_->upload<std::uint8_t>(0x2033), scale - 20) << "0.625 ms a step downwards";
  bus_->pass(300_ms);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x2033), 50);
}

TEST_F(ClosedLoopModule, NeitherStandbyNorBoostCurrentIsUsed) {
  go_operational();
  write<std::uint8_t>(0x204E, 255);
  write<std::uint16_t>(0x2089, 1);
  start_closed_loop(3);
  write<std::uint8_t>(0x2029, 255);
  bus_->pass(500_ms);
  EXPECT_NEAR(signal("axis0.coil_current_a"), 11.0 / 32.0 * 3.0, 0.01) << "at standstill";
  set_profile(0, 0, 51'200);
  write<std::int32_t>(0x60FF, 51'200);
  bus_->pass(300_ms);
  EXPECT_NEAR(std::hypot(signal("axis0.coil_current_a"), signal("axis0.coil_current_b")),
              11.0 / 32.0 * 3.0, 0.02)
      << "accelerating";
}

/// Velocity the shaft reaches at 24 V with a field weakening angle.
class FieldWeakening : public ClosedLoopModule {
 protected:
  double highest_velocity(std::uint8_t gamma) {
    renew(with_encoder());
    go_operational();
    start_closed_loop(3);
    write<std::uint8_t>(0x2003, 255);
    write<std::uint8_t>(0x2036, gamma);
    set_profile(0, 0, 1'000'000);
    write<std::int32_t>(0x60FF, 1'600'000);
    bus_->pass(3_s);
    return bus_->upload<std::int32_t>(0x606C);
  }
};

TEST_F(FieldWeakening, MakesTheShaftFasterAtTheSameSupply) {
  const double without = highest_velocity(0);
  EXPECT_GT(without, 1'000'000.0);
  EXPECT_LT(without, 1'300'000.0) << "back EMF and 90 degree end it";
  EXPECT_NEAR(highest_velocity(255), 1'600'000.0, 16'000.0);
}

TEST_F(ClosedLoopModule, InitialisationStartsWithTheDriveAndEndsWithIt) {
  go_operational();
  write_example();
  write<std::uint8_t>(0x2020, 1);
  bus_->pass(500_ms);
  EXPECT_FALSE(initialised()) << "no current, nothing to measure";
  enable(0, 1);
  await_initialisation();
  control(0, 7);
  bus_->pass(2_ms);
  EXPECT_FALSE(initialised());
  control(0, 15);
  EXPECT_FALSE(initialised()) << "anew each time";
  await_initialisation();
  write<std::uint8_t>(0x2020, 0);
  bus_->pass(3_ms);
  EXPECT_FALSE(initialised());
}

TEST_F(ClosedLoopModule, InitialisationWaitsForTheEndOfAMotion) {
  go_operational();
  write_example();
  enable(0, 1);
  set_profile(0, 51'200, 512'000);
  start_move(0, 51'200);
  write<std::uint8_t>(0x2020, 1);
  bus_->pass(900_ms);
  EXPECT_FALSE(initialised());
  bus_->pass(600_ms);
  EXPECT_TRUE(initialised());
}

class ClosedLoopWithAnyEncoder : public ClosedLoopModule,
                                 public testing::WithParamInterface<double> {
 protected:
  static Tmcm3315Configuration configuration() {
    Tmcm3315Configuration configuration = with_encoder(40'000);
    configuration.axes[0].initial_revolutions = GetParam();
    configuration.axes[0].encoder.offset = 1000.0 * GetParam();
    configuration.axes[0].encoder.reversed = GetParam() < 0.0;
    return configuration;
  }
  ClosedLoopWithAnyEncoder() : ClosedLoopModule(configuration()) {}
};

TEST_P(ClosedLoopWithAnyEncoder, TheOffsetIsMeasuredAndTheMotorTurnsUnderLoad) {
  go_operational();
  write_example();
  write<std::uint32_t>(0x608F, 40'000, 1);
  write<std::uint8_t>(0x200B, GetParam() < 0.0 ? 1 : 0, 2);
  enable(0, 1);
  const std::int32_t before = bus_->upload<std::int32_t>(0x6064);
  write<std::uint8_t>(0x2020, 1);
  await_initialisation();
  // Electrical position 0 of vector and rotor: offset + encoder is a whole number of periods away.
  const double encoder = signal("axis0.encoder") * 1.28 * (GetParam() < 0.0 ? -1.0 : 1.0);
  EXPECT_NEAR(std::remainder(bus_->upload<std::int32_t>(0x2028) + encoder, 1024.0), 0.0, 2.0);
  set_profile(0, 51'200, 512'000);
  load(-0.12);
  const double start = shaft_microsteps();
  start_move(0, before + 51'200);
  bus_->pass(1500_ms);
  load(0.0);
  bus_->pass(500_ms);
  const double demand = signal("axis0.position_demand") - before;
  EXPECT_EQ(demand, 51'200.0);
  EXPECT_NEAR(shaft_microsteps() - start, 51'200.0, kDetent);
}
INSTANTIATE_TEST_SUITE_P(Zeros, ClosedLoopWithAnyEncoder,
                         testing::Values(0.0, 0.1234, -0.317, 2.5, -1.0031));

TEST_F(ClosedLoopModule, BackInOpenLoopNothingJumps) {
  go_operational();
  start_closed_loop();
  set_profile(0, 51'200, 512'000);
  start_move(0, 51'200);
  bus_->pass(2_s);
  write<std::uint32_t>(0x202B, 0);
  write<std::uint32_t>(0x202C, 0);
  load(-0.4);
  bus_->pass(5_ms);
  load(0.0);
  bus_->pass(500_ms);  // no regulator: the motor stays behind the demand
  const std::int32_t demand = bus_->upload<std::int32_t>(0x6062);
  const std::int32_t actual = bus_->upload<std::int32_t>(0x6064);
  const double shaft = shaft_microsteps();
  const auto steps = bus_->upload<std::uint32_t>(0x210B, 1);
  ASSERT_GT(demand - actual, 100);
  write<std::uint8_t>(0x2020, 0);
  bus_->pass(500_ms);
  EXPECT_NEAR(shaft_microsteps(), shaft, kDetent) << "but for the detent torque at more current";
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), demand);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x6064), actual, kDetent);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x210B, 1), steps);
  const double rest = shaft_microsteps();
  start_move(0, demand + 10'000);
  bus_->pass(1_s);
  EXPECT_NEAR(shaft_microsteps(), rest + 10'000.0, 16.0);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x210B, 1), steps + 10'000);
}

TEST_F(ClosedLoopModule, RenamingThePositionDoesNotMoveTheMotor) {
  go_operational();
  start_closed_loop();
  set_profile(0, 51'200, 512'000);
  start_move(0, 12'345);
  bus_->pass(1_s);
  const double shaft = shaft_microsteps();
  write<std::int8_t>(0x6060, 6);
  write<std::int8_t>(0x6098, 35);
  control(0, 31);
  bus_->pass(200_ms);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), 0);
  EXPECT_NEAR(shaft_microsteps(), shaft, 3.0);
  EXPECT_TRUE(initialised());
}

TEST_F(ClosedLoopModule, ALiveChangeOfResolutionDoesNotMoveTheMotor) {
  go_operational();
  start_closed_loop();
  set_profile(0, 51'200, 512'000);
  start_move(0, 12'345);
  bus_->pass(1_s);
  const double shaft = shaft_microsteps();
  const auto actual = bus_->upload<std::int32_t>(0x6064);
  write<std::uint8_t>(0x2000, 5);
  for (int i = 0; i < 100; ++i) {
    bus_->pass(1_ms);
    ASSERT_NEAR(shaft_microsteps(), shaft, 10.0) << "no jolt either";
  }
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), 12'345);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x6064), actual, 1);
  EXPECT_TRUE(initialised());
}

TEST_F(ClosedLoopModule, ABlockedShaftRaisesAFollowingError) {
  Tmcm3315Configuration configuration = with_encoder();
  configuration.axes[0].load.end_stop_maximum = 0.5;
  renew(configuration);
  go_operational();
  start_closed_loop();
  write<std::uint32_t>(0x6065, 5000);
  set_profile(0, 51'200, 512'000);
  start_move(0, 100'000);
  bus_->pass(2_s);
  EXPECT_EQ(statusword() & 0x004F, 0x0008) << "fault";
  bool told = false;
  for (const Emergency& emergency : bus_->take_emergencies()) {
    told = told || (emergency[0] == 0x11 && emergency[1] == 0x86);
  }
  EXPECT_TRUE(told) << "8611h";
}

class ClosedLoopRefusals : public ClosedLoopModule {
 protected:
  ClosedLoopRefusals() {
    go_operational();
    write_example();
    enable(0, 1);
  }
};

TEST_F(ClosedLoopRefusals, WithoutAnEncoderTheAxisStaysInOpenLoopAndSaysWhy) {
  write<std::int16_t>(0x606A, -1);
  write<std::uint8_t>(0x2020, 1);
  bus_->pass(500_ms);
  EXPECT_FALSE(initialised());
  EXPECT_EQ(told_.count("606Ah is -1"), 1);
  write<std::int16_t>(0x606A, 0);
  await_initialisation();
  write<std::int16_t>(0x606A, -1);
  bus_->pass(2_ms);
  EXPECT_FALSE(initialised()) << "the encoder was taken away";
}

TEST_F(ClosedLoopRefusals, AnAbsurdResolutionIsNotUsed) {
  write<std::uint8_t>(0x2020, 1);
  for (const std::uint32_t counts : {1U, 799U, 16'777'217U}) {
    write<std::uint32_t>(0x608F, counts, 1);
    bus_->pass(300_ms);
    EXPECT_FALSE(initialised()) << counts;
  }
  EXPECT_GE(told_.count("608Fh:01"), 1);
}

TEST_F(ClosedLoopRefusals, ATorqueWithoutClosedLoopIsExplained) {
  write<std::int8_t>(0x6060, 10);
  bus_->pass(20_ms);
  EXPECT_EQ(told_.count("mode 10 needs closed loop"), 1);
}

TEST_F(ClosedLoopRefusals, APositionGainOfZeroIsToldOnce) {
  write<std::uint32_t>(0x2021, 0);
  write<std::uint8_t>(0x2020, 1);
  await_initialisation();
  EXPECT_EQ(told_.count("gain (P) of 0"), 1);
}

}  // namespace
}  // namespace stator::devices
