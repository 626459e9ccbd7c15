// What ends a motion ends it at the shaft: stops of a TMC8670 whose shaft lags behind its
// set-point, against what a laboratory would measure there.

#include "devices/tmc8670_cycles.hpp"

namespace stator::devices {
namespace {

class Tmc8670Stop : public Tmc8670Cycles {};

// Targets that jump

TEST_F(Tmc8670Stop, AJumpOfTheCyclicTargetThatFaultsBrakesTheShaftOnTheQuickStopRamp) {
  write<std::uint16_t>(0x6066, 0);
  write<std::uint32_t>(0x6085, 10'000);
  enable_in(8);
  position_ = actual() + 5 * kTurn;
  cycle(1_ms);
  forget();
  cycle(500_ms);
  EXPECT_LT(fastest(), 300.0) << "the fault came with the first following error";
  EXPECT_LT(travelled(), 0.5);
  EXPECT_LE(speed_at_power_off(), kStands);
  EXPECT_EQ(seen().statusword & 0x4F, 0x08) << "Fault";
}

TEST_F(Tmc8670Stop, AFaultWithTheShaftFarBehindTheTargetBrakesItBeforeThePowerGoesOff) {
  write<std::uint32_t>(0x6085, 10'000);
  enable_in(8);
  position_ = actual() + 20 * kTurn;
  ASSERT_TRUE(cycle_until([&] { return (seen().statusword & 0x4F) == 0x0F; }, 1_s));
  ASSERT_GT(seen().rpm, 3000.0) << "after the 100 ms of 6066h";
  forget();
  cycle(1_s);
  expect_stop(10'000.0);
  EXPECT_EQ(seen().statusword & 0x4F, 0x08);
}

TEST_F(Tmc8670Stop, InitStopsAShaftThatFollowsAJump) {
  write<std::uint32_t>(0x6065, 0xFFFFFFFF);
  write<std::uint32_t>(0x6085, 20'000);
  enable_in(8);
  position_ = actual() + 50 * kTurn;
  cycle(60_ms);
  ASSERT_GT(seen().rpm, 3000.0);
  forget();
  EXPECT_EQ(bus_->request(AlState::init), 0x01);
  wait(1_s);
  expect_stop(20'000.0);
  EXPECT_FALSE(seen().powered);
}

/// Ways to stop in Operation enabled after which the drive stays there or in Quick stop active.
TEST_F(Tmc8670Stop, HaltAndQuickStopEndAJumpOfFiftyTurnsOnTheirRamps) {
  struct Way {
    const char* name;
    int halt_option;
    int quick_stop_option;
    int controlword;
    double deceleration;
  };
  for (const Way& way :
       {Way{"halt 1", 1, 2, 0x010F, 20'000.0}, Way{"halt 2", 2, 2, 0x010F, 50'000.0},
        Way{"halt 3", 3, 2, 0x010F, 80'000.0}, Way{"quick stop 5", 1, 5, 0x0002, 20'000.0},
        Way{"quick stop 6", 1, 6, 0x0002, 50'000.0}}) {
    SCOPED_TRACE(way.name);
    renew(servo());
    go_operational();
    write<std::int16_t>(0x605D, static_cast<std::int16_t>(way.halt_option));
    write<std::int16_t>(0x605A, static_cast<std::int16_t>(way.quick_stop_option));
    write<std::uint32_t>(0x6065, 0xFFFFFFFF);
    enable_in(8);
    position_ = actual() - 50 * kTurn;
    cycle(50_ms);
    ASSERT_LT(seen().rpm, -3000.0);
    forget();
    command(way.controlword);
    cycle(1_s);
    expect_stop(way.deceleration);
    EXPECT_TRUE(seen().powered);
    position_ = 0;
  }
}

TEST_F(Tmc8670Stop, AStaleTargetAtEnablingCanBeStopped) {
  write<std::uint32_t>(0x6065, 0xFFFFFFFF);
  position_ = 20 * kTurn;
  enable_in(8);
  cycle(40_ms);
  forget();
  command(0x010F);
  cycle(1_s);
  expect_stop(20'000.0);
  EXPECT_TRUE(seen().powered);
}

// Stops of a shaft that lags as every shaft does

class Tmc8670StopOnTheWay : public Tmc8670Stop {
 protected:
  /// In pp to a far target with `rpm`.
  void travel(std::uint32_t rpm) {
    write<std::uint32_t>(0x6065, 0xFFFFFFFF);
    write<std::uint32_t>(0x6081, rpm);
    enable_in(1);
    move_to(1000 * kTurn);
    cycle(400_ms);
    ASSERT_NEAR(seen().rpm, rpm, 30.0);
  }
};

TEST_F(Tmc8670StopOnTheWay, AQuickStopSwitchesThePowerOffWhenTheShaftStands) {
  for (const std::uint32_t rpm : {2000U, 3000U}) {
    SCOPED_TRACE(rpm);
    renew(servo());
    go_operational();
    position_ = 0;
    travel(rpm);
    forget();
    command(0x0002);
    cycle(500_ms);
    expect_stop(50'000.0);
    EXPECT_FALSE(seen().powered);
  }
}

TEST_F(Tmc8670StopOnTheWay, ShutdownAndDisablingSwitchThePowerOffWhenTheShaftStands) {
  for (const int controlword : {0x06, 0x07}) {
    SCOPED_TRACE(controlword);
    renew(servo());
    go_operational();
    write<std::int16_t>(0x605B, 1);
    write<std::int16_t>(0x605C, 1);
    position_ = 0;
    travel(2000);
    forget();
    command(controlword);
    cycle(500_ms);
    expect_stop(20'000.0);
    EXPECT_FALSE(seen().powered);
  }
}

TEST_F(Tmc8670StopOnTheWay, LeavingOperationalSwitchesThePowerOffWhenTheShaftStands) {
  travel(2000);
  forget();
  EXPECT_EQ(bus_->request(AlState::safe_operational), 0x04);
  wait(500_ms);
  expect_stop(50'000.0);
  EXPECT_FALSE(seen().powered);
}

TEST_F(Tmc8670StopOnTheWay, InCyclicPositionTheShaftIsBrakedToo) {
  enable_in(8);
  position_ = actual();
  for (int k = 0; k < 400; ++k) {
    position_ += static_cast<std::int32_t>(std::min(k * 20, 2184));  // 2000 rpm
    cycle(1_ms);
  }
  ASSERT_NEAR(seen().rpm, 2000.0, 30.0);
  forget();
  command(0x0002);
  cycle(500_ms);
  expect_stop(50'000.0);
  EXPECT_FALSE(seen().powered);
}

TEST_F(Tmc8670StopOnTheWay, InHomingTheShaftIsBrakedToo) {
  write<std::int8_t>(0x6098, 17);
  write<std::uint32_t>(0x6099, 2000, 1);
  write<std::uint32_t>(0x6099, 100, 2);
  write<std::uint32_t>(0x609A, 20'000);
  enable_in(6);
  command(0x1F);
  cycle(400_ms);
  ASSERT_NEAR(seen().rpm, -2000.0, 30.0);
  forget();
  command(0x0002);
  cycle(500_ms);
  expect_stop(50'000.0);
  EXPECT_FALSE(seen().powered);
}

TEST_F(Tmc8670StopOnTheWay, WithLittleTorqueThePowerStaysOnUntilTheShaftStands) {
  write<std::uint32_t>(0x6065, 0xFFFFFFFF);
  enable_in(3);
  velocity_ = 2000;
  cycle(500_ms);
  write<std::uint16_t>(0x6072, 100);
  cycle(100_ms);
  forget();
  command(0x0002);
  cycle(3_s);
  EXPECT_LE(fastest(), 2050.0);
  EXPECT_LE(speed_at_power_off(), kStands);
  EXPECT_FALSE(seen().powered) << "and goes off then";
}

TEST_F(Tmc8670StopOnTheWay, HaltIsReachedWhenTheShaftStands) {
  for (const int option : {1, 2, 3}) {
    SCOPED_TRACE(option);
    renew(servo());
    go_operational();
    write<std::int16_t>(0x605D, static_cast<std::int16_t>(option));
    position_ = 0;
    travel(2000);
    forget();
    command(0x010F);
    cycle(500_ms);
    EXPECT_LE(speed_at_target_reached(), kStands);
    EXPECT_TRUE(has(kReached));
    expect_stop(option == 1 ? 20'000.0 : 50'000.0);
  }
}

TEST_F(Tmc8670StopOnTheWay, WithLittleTorqueHaltBrakesWithAllOfIt) {
  write<std::uint32_t>(0x6065, 0xFFFFFFFF);
  write<std::uint16_t>(0x6072, 100);
  enable_in(1);
  move_to(1000 * kTurn);
  ASSERT_TRUE(cycle_until([&] { return seen().rpm > 500.0; }, 10_s));
  const double begin = seen().rpm;
  forget();
  command(0x010F);
  cycle(3_s);
  // The torque that brought it to that speed, and friction, take it away again.
  EXPECT_LE(fastest(), begin + 60.0);
  EXPECT_LE(travelled(), 4.0);
  EXPECT_LE(std::fabs(seen().rpm), kStands);
  EXPECT_LE(speed_at_target_reached(), kStands);
}

TEST_F(Tmc8670StopOnTheWay, AJammedShaftThatIsFreedUnderHaltStaysWhereItIs) {
  write<std::uint32_t>(0x6065, 0xFFFFFFFF);
  enable_in(1);
  set_input("axis0.jamming_torque", 1.0);
  move_to(1000 * kTurn);
  cycle(400_ms);
  ASSERT_LT(std::fabs(seen().rpm), 5.0);
  command(0x010F);
  cycle(200_ms);
  forget();
  set_input("axis0.jamming_torque", 0.0);
  cycle(1_s);
  // What it is off its place by has been summed up while it could not turn.
  EXPECT_LT(fastest(), 300.0);
  EXPECT_LT(travelled(), 0.1);
  EXPECT_TRUE(has(kReached));
}

// 6082h

TEST_F(Tmc8670Stop, AnEndVelocityGoesOnBehindTheTargetWithoutAStep) {
  write<std::uint32_t>(0x6082, 500);
  enable_in(1);
  forget();
  move_to(10 * kTurn);
  cycle(1_s);
  EXPECT_NEAR(seen().rpm, 500.0, 15.0);
  EXPECT_LE(steepest(), 1.3 * 20'000.0);
  const auto passed = std::find_if(trace_.begin(), trace_.end(),
                                   [](const Sample& sample) { return sample.revolutions >= 10.0; });
  ASSERT_NE(passed, trace_.end());
  EXPECT_NEAR(passed->rpm, 500.0, 100.0) << "the velocity on the target";
  forget();
  command(0x010F);
  cycle(300_ms);
  expect_stop(20'000.0);
  EXPECT_TRUE(has(kReached));
}

}  // namespace
}  // namespace stator::devices
