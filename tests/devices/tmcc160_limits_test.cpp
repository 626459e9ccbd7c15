// Limit switches and software limits of a TMCC160, judged by its shaft: with end velocities, with a
// shaft that comes free, with a load that drives, and with parameters written under way.

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "devices/tmcc160_shaft_drive.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"

namespace stator::devices {
namespace {

using plant::PositionSwitch;

constexpr double kYielding = 5'000.0;  ///< ms in which halls, step by step, lead a shaft back

/// pv left with -500 rpm; then pp to 8 revolutions and on with 300 rpm.
void go_on_behind_a_target(ShaftDrive& drive, bool velocity_mode_before, double limit_revolutions) {
  if (velocity_mode_before) {
    drive.start(kVelocity);
    drive.put(0x60FF, 0, -500);
    drive.wait(500);
    drive.put(0x6060, 0, kPosition);
    drive.wait(1'500);
  } else {
    drive.start(kPosition);
  }
  ASSERT_LT(std::abs(drive.rpm()), kStanding);
  drive.put(0x6081, 0, 600);
  drive.put(0x6082, 0, 300);
  if (std::isfinite(limit_revolutions)) {
    drive.put(0x607D, 2,
              std::round(limit_revolutions * drive.steps_per_revolution) + drive.value(0x6064));
  }
  drive.move_by(200.0 / kHallSteps);
}

TEST(Tmcc160Limits, AnEndVelocityEndsAtASoftwareLimitOnARampWhateverModeWasBefore) {
  for (const double steps : {kHallSteps, kEncoderSteps}) {
    for (const bool velocity_mode_before : {false, true}) {
      SCOPED_TRACE(std::to_string(steps) + (velocity_mode_before ? " after pv" : ""));
      ShaftDrive drive(steps);
      const double limit = 1'000.0 / kHallSteps;
      go_on_behind_a_target(drive, velocity_mode_before, limit);
      const double begin = drive.revolutions();
      const Stop stop = drive.watch(20'000);
      EXPECT_LE(stop.steepest_demand, 1.2 * 2.0) << "6084h, 2 rpm per ms";
      EXPECT_NEAR(drive.revolutions() - begin, limit, 1.0);
      EXPECT_LE(std::abs(stop.final_rpm), kStanding) << "it stays there";
      EXPECT_TRUE(stop.limited_at_end);
    }
  }
}

TEST(Tmcc160Limits, AnEndVelocityEndsAtALimitSwitchWhateverModeWasBefore) {
  for (const double steps : {kHallSteps, kEncoderSteps}) {
    Tmcc160Configuration configuration;
    configuration.axis.right_switch = PositionSwitch::right_at(20.0);
    ShaftDrive drive(steps, configuration);
    go_on_behind_a_target(drive, true, std::numeric_limits<double>::infinity());
    const Stop stop = drive.watch(20'000);
    EXPECT_LE(stop.steepest_demand, 1.2 * 2.0) << steps;
    EXPECT_LE(drive.revolutions(), 21.0) << steps;
    EXPECT_LE(std::abs(stop.final_rpm), kStanding) << steps;
    EXPECT_TRUE(stop.limited_at_end) << steps;
  }
}

TEST(Tmcc160Limits, AnEndVelocityGoesOnBehindItsTargetAfterAHalt) {
  for (const double steps : {kHallSteps, kEncoderSteps}) {
    ShaftDrive drive(steps);
    go_on_behind_a_target(drive, false, std::numeric_limits<double>::infinity());
    drive.wait(3'000);
    ASSERT_NEAR(drive.rpm(), 300.0, 60.0) << "behind its target";
    drive.control(kHalt);
    expect_ramp(drive.watch(1'000), 2'000.0);
    const double halted = drive.revolutions();
    drive.control(kRun);
    double lowest = 0.0;
    for (int passed = 0; passed < 3'000; ++passed) {
      drive.wait(1);
      lowest = std::min(lowest, drive.rpm());
    }
    EXPECT_GE(lowest, -kStanding) << "not back to the target it has passed; " << steps;
    EXPECT_NEAR(drive.rpm(), 300.0, 60.0) << steps;
    EXPECT_GT(drive.revolutions(), halted + 10.0) << steps;
  }
}

TEST(Tmcc160Limits, AShaftThatComesFreeIsStoppedByALimitSwitchFromTheSpeedItHas) {
  for (const double steps : {kHallSteps, kEncoderSteps}) {
    Tmcc160Configuration configuration;
    configuration.axis.right_switch = PositionSwitch::right_at(5.0);
    ShaftDrive drive(steps, configuration);
    drive.put(0x2090, 1, 1);
    drive.put(0x2005, 0, 2);  // only after the switch's first look
    drive.put(0x2005, 0, 0);
    jam_under_way(drive);
    drive.set("axis0.jammed", 0);
    for (int passed = 0; drive.revolutions() < 5.0 && passed < 3'000; ++passed) {
      drive.wait(1);
    }
    ASSERT_GE(drive.revolutions(), 5.0);
    const Stop stop = drive.watch(4'000);
    expect_ramp(stop, 2'000.0);
    EXPECT_TRUE(stop.limited_at_end) << "b11 while the switch holds the axis; " << steps;
    EXPECT_EQ(stop.status & kTargetReached, 0U) << "the target is not reached";
  }
}

void let_the_load_drive(ShaftDrive& drive) {
  drive.put(0x2090, 1, 1);
  drive.ramps(20'000);
  drive.start(kTorque);
  drive.put(0x6071, 0, 0);
}

TEST(Tmcc160Limits, ALimitSwitchHoldsAnAxisWithoutTorqueThatItsLoadDrives) {
  for (const double steps : {kHallSteps, kEncoderSteps}) {
    Tmcc160Configuration configuration;
    configuration.axis.right_switch = PositionSwitch::right_at(2.0);
    ShaftDrive drive(steps, configuration);
    let_the_load_drive(drive);
    drive.set("axis0.load_torque", 0.02);
    for (int passed = 0; drive.revolutions() < 2.0 && passed < 2'000; ++passed) {
      drive.wait(1);
    }
    const Stop stop = drive.watch(6'000);
    expect_ramp(stop, 20'000.0, kYielding, 1.0);
    EXPECT_TRUE(stop.limited_at_end) << steps;
    EXPECT_FALSE(stop.fault);
    const double held = drive.revolutions();
    drive.wait(10'000);
    EXPECT_NEAR(drive.revolutions(), held, 0.1) << "it does not creep";
    drive.put(0x6071, 0, -1'500);
    drive.wait(500);
    EXPECT_LT(drive.revolutions(), held - 0.2) << "a torque that points away frees it";
  }
}

TEST(Tmcc160Limits, ASoftwareLimitHoldsAnAxisWithoutTorqueThatItsLoadDrives) {
  for (const double steps : {kHallSteps, kEncoderSteps}) {
    ShaftDrive drive(steps);
    drive.put(0x607D, 2, 2.0 * steps);
    let_the_load_drive(drive);
    drive.set("axis0.load_torque", 0.02);
    for (int passed = 0; drive.revolutions() < 2.0 && passed < 2'000; ++passed) {
      drive.wait(1);
    }
    const Stop stop = drive.watch(6'000);
    expect_ramp(stop, 20'000.0, kYielding, 1.0);
    EXPECT_TRUE(stop.limited_at_end) << steps;
    const double held = drive.revolutions();
    drive.wait(10'000);
    EXPECT_NEAR(drive.revolutions(), held, 0.1) << "it does not creep";
  }
}

TEST(Tmcc160Limits, ASoftwareLimitLoweredUnderWayStopsTheMoveThere) {
  for (const double steps : {kHallSteps, kEncoderSteps}) {
    ShaftDrive drive(steps);
    drive.start(kPosition);
    drive.put(0x6081, 0, 600);
    drive.move_by(50.0);
    drive.wait(1'000);
    ASSERT_LT(drive.revolutions(), 15.0);
    drive.put(0x607D, 2, 20.0 * steps);
    const Stop stop = drive.watch(8'000);
    EXPECT_NEAR(drive.revolutions(), 20.0, 1.0) << steps;
    EXPECT_LE(stop.steepest_demand, 1.2 * 2.0);
    EXPECT_TRUE(stop.limited_at_end) << steps;
  }
}

TEST(Tmcc160Limits, SwitchParametersActWithoutWaitingForASwitchToChange) {
  ShaftDrive drive;  // both switches released, unused
  drive.start(kVelocity);
  drive.put(0x60FF, 0, 300);
  drive.wait(500);
  ASSERT_NEAR(drive.rpm(), 300.0, 60.0);
  drive.put(0x2005, 0, 8);  // both used, right one inverted: pressed
  const Stop stop = drive.watch(500);
  expect_ramp(stop, 2'000.0);
  EXPECT_TRUE(stop.limited_at_end);
  drive.put(0x2005, 0, 0);
  drive.put(0x60FF, 0, 301);
  drive.wait(500);
  EXPECT_NEAR(drive.rpm(), 301.0, 60.0) << "released";
}

TEST(Tmcc160Limits, ASwitchThatIsPressedAlreadyBlocksFromTheWriteThatUsesIt) {
  ShaftDrive drive;
  drive.set("axis0.right_switch", 1);
  drive.wait(5);
  drive.start(kVelocity);
  drive.put(0x2005, 0, 1);  // the right one used
  drive.put(0x60FF, 0, 300);
  drive.wait(500);
  EXPECT_LE(std::abs(drive.rpm()), kStanding);
  EXPECT_NE(drive.status() & kLimited, 0U);
  drive.put(0x60FF, 0, -300);
  drive.wait(500);
  EXPECT_NEAR(drive.rpm(), -300.0, 60.0);
}

}  // namespace
}  // namespace stator::devices
