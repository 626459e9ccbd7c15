// What stops a TMCC160, judged by its shaft: stops of every kind while the shaft lags behind the
// set-point, is heavier than the ramp or turns without power.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "devices/tmcc160_shaft_drive.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"

namespace stator::devices {
namespace {

TEST(Tmcc160Stop, AShaftThatComesFreeUnderHaltStaysWhereItIs) {
  for (const double steps : {kHallSteps, kEncoderSteps}) {
    ShaftDrive drive(steps);
    jam_under_way(drive);
    drive.control(kHalt);
    drive.wait(500);
    const double jammed = drive.revolutions();
    drive.set("axis0.jammed", 0);
    const Stop stop = drive.watch(4'000);
    EXPECT_LE(stop.largest_rpm, 700.0) << "by what the loop pushed with; " << steps;
    EXPECT_NEAR(drive.revolutions(), jammed, 0.5) << steps;
    EXPECT_LE(stop.untrue_bit_10, kUnseen);
  }
}

TEST(Tmcc160Stop, AfterAStopTheShaftRests) {
  for (const double steps : {kHallSteps, kEncoderSteps}) {
    ShaftDrive drive(steps);
    drive.start(kPosition);
    drive.put(0x605A, 0, 5);
    drive.put(0x6081, 0, 1'000);
    drive.move_by(500.0);
    drive.wait(2'000);
    drive.control(0x02);
    drive.wait(3'000);
    double lowest = drive.revolutions();
    double highest = lowest;
    for (int passed = 0; passed < 20'000; ++passed) {
      drive.wait(1);
      lowest = std::min(lowest, drive.revolutions());
      highest = std::max(highest, drive.revolutions());
    }
    EXPECT_LT((highest - lowest) * steps, 1.0) << steps;
  }
}

/// With 12 V the motor does not reach the 4000 rpm it shall: the set-point runs away from it.
class TooLowASupply : public testing::TestWithParam<double> {
 protected:
  TooLowASupply() {
    drive_.set("axis0.supply_voltage", 12.0);
    drive_.start(kPosition);
    drive_.put(0x6081, 0, 4'000);
    drive_.move_by(2'000.0);
    drive_.wait(6'000);
    EXPECT_NEAR(drive_.rpm(), 3'100.0, 200.0);
  }
  ShaftDrive drive_{GetParam()};
};

TEST_P(TooLowASupply, HaltStopsTheShaft) {
  drive_.control(kHalt);
  const Stop stop = drive_.watch(4'000);
  expect_ramp(stop, 2'000.0);
  EXPECT_FALSE(stop.fault);
  EXPECT_NE(stop.status & kTargetReached, 0U) << "it stands";
}

TEST_P(TooLowASupply, QuickStopBrakesTheShaftBeforeThePowerGoes) {
  drive_.control(kQuickStop);
  const Stop stop = drive_.watch(4'000);
  expect_ramp(stop, 2'000.0);
  EXPECT_FALSE(stop.fault);
  EXPECT_EQ(stop.status & 0x4FU, 0x40U) << "605Ah = 2: Switch on disabled";
}

TEST_P(TooLowASupply, DisableOperationBrakesTheShaftBeforeThePowerGoes) {
  drive_.control(kDisableOperation);
  const Stop stop = drive_.watch(4'000);
  expect_ramp(stop, 2'000.0);
  EXPECT_FALSE(stop.fault);
  EXPECT_EQ(stop.status & 0x6FU, 0x23U) << "605Ch = 1";
}

TEST_P(TooLowASupply, NmtStoppedBrakesTheShaftBeforeThePowerGoes) {
  drive_.nmt(2);
  const Stop stop = drive_.watch(4'000);
  expect_ramp(stop, 2'000.0);
  EXPECT_EQ(stop.status & 0x4FU, 0x08U) << "A-05";
}

TEST_P(TooLowASupply, AnotherModeBeginsWhenTheShaftHasBeenBraked) {
  drive_.put(0x60FF, 0, 0);
  drive_.put(0x6060, 0, kVelocity);
  const Stop stop = drive_.watch(4'000);
  expect_ramp(stop, 2'000.0);
  EXPECT_FALSE(stop.fault);
  EXPECT_LT(stop.highest_supply, 24.0);
  EXPECT_EQ(drive_.read(0x6061), kVelocity);
}

INSTANTIATE_TEST_SUITE_P(Tmcc160, TooLowASupply, testing::Values(kHallSteps, kEncoderSteps),
                         [](const testing::TestParamInfo<double>& steps) {
                           return steps.param == kHallSteps ? "WithHalls" : "WithAnEncoder";
                         });

/// A wheel that the largest torque brakes by 1190 rpm/s, where the ramps as delivered ask for 2000,
/// and a brake chopper for what it feeds back.
class HeavyWheel : public testing::TestWithParam<double> {
 protected:
  static Tmcc160Configuration with_wheel() {
    Tmcc160Configuration configuration;
    configuration.axis.load.inertia = 1e-3;
    return configuration;
  }
  HeavyWheel() {
    drive_.put(0x2090, 1, 1);
    drive_.start(kVelocity);
    drive_.put(0x60FF, 0, 3'200);
    drive_.wait(6'000);
    EXPECT_NEAR(drive_.rpm(), 3'200.0, 300.0);
  }
  static constexpr double kPossible = 1'190.0;   ///< rpm/s with 4 A
  static constexpr double kSettling = 10'000.0;  ///< ms; with such a wheel the velocity loop swings
  ShaftDrive drive_{GetParam(), with_wheel()};
};

TEST_P(HeavyWheel, HaltTellsOfAShaftThatStands) {
  drive_.control(kHalt);
  const Stop stop = drive_.watch(14'000);
  expect_ramp(stop, kPossible, kSettling);
  EXPECT_FALSE(stop.fault);
}

TEST_P(HeavyWheel, QuickStopKeepsThePowerUntilTheShaftStandsHoweverSteepTheRamp) {
  drive_.put(0x2020, 3, 100'000);
  drive_.put(0x6085, 0, 100'000);
  drive_.control(kQuickStop);
  const Stop stop = drive_.watch(14'000);
  expect_ramp(stop, kPossible, kSettling);
  EXPECT_FALSE(stop.fault);
}

TEST_P(HeavyWheel, DisableOperationKeepsThePowerUntilTheShaftStands) {
  drive_.control(kDisableOperation);
  const Stop stop = drive_.watch(14'000);
  expect_ramp(stop, kPossible, kSettling);
  EXPECT_FALSE(stop.fault);
}

INSTANTIATE_TEST_SUITE_P(Tmcc160, HeavyWheel, testing::Values(kHallSteps, kEncoderSteps),
                         [](const testing::TestParamInfo<double>& steps) {
                           return steps.param == kHallSteps ? "WithHalls" : "WithAnEncoder";
                         });

TEST(Tmcc160Stop, ADecelerationOf0UnderWayDoesNotTakeTheDemandAwayAtOnce) {
  for (const DriveMode mode : {kPosition, kVelocity}) {
    ShaftDrive drive;
    drive.start(mode);
    drive.put(0x60FF, 0, 1'000);
    drive.put(0x6081, 0, 1'000);
    drive.move_by(200.0);
    drive.wait(1'500);
    ASSERT_NEAR(drive.rpm(), 1'000.0, 60.0);
    drive.put(0x6084, 0, 0);
    const Stop stop = drive.watch(2'000);
    EXPECT_LE(stop.steepest_demand, 1.2 * 2.0) << int{mode};
    EXPECT_FALSE(stop.fault);
  }
}

TEST(Tmcc160Stop, EnablingAMotorThatCoastsBeginsFromItsSpeed) {
  for (const double steps : {kHallSteps, kEncoderSteps}) {
    ShaftDrive drive(steps);
    drive.start(kVelocity);
    drive.put(0x60FF, 0, 3'000);
    drive.wait(2'500);
    drive.control(0x00);
    drive.wait(10);
    drive.control(0x06);
    drive.control(0x07);
    ASSERT_GT(drive.rpm(), 2'000.0) << "it coasts";
    drive.put(0x60FF, 0, 0);
    drive.control(0x0F);
    const Stop stop = drive.watch(3'000);
    expect_ramp(stop, 2'000.0);
    EXPECT_FALSE(stop.fault) << steps;
    EXPECT_LT(stop.highest_supply, 26.0) << steps;
  }
}

TEST(Tmcc160Stop, AnOvervoltageTakesThePowerOffAndTheSupplyRisesNoFurther) {
  for (const double steps : {kHallSteps, kEncoderSteps}) {
    Tmcc160Configuration configuration;
    configuration.axis.load.inertia = 1e-3;
    ShaftDrive drive(steps, configuration);
    drive.start(kVelocity);
    drive.put(0x60FF, 0, 3'000);
    drive.wait(6'000);
    drive.put(0x60FF, 0, 0);
    const Stop stop = drive.watch(1'000);
    EXPECT_TRUE(stop.fault) << "braking feeds the supply, and no chopper burns it";
    EXPECT_EQ(stop.status & 0x4FU, 0x08U) << "Fault";
    EXPECT_LT(stop.highest_supply, 32.0) << steps;
    EXPECT_GT(stop.final_rpm, 2'000.0) << "it coasts";
  }
}

TEST(Tmcc160Stop, TheBrakeChopperLetsTheSameWheelBrake) {
  Tmcc160Configuration configuration;
  configuration.axis.load.inertia = 1e-3;
  ShaftDrive drive(kEncoderSteps, configuration);
  drive.put(0x2090, 1, 1);
  drive.start(kVelocity);
  drive.put(0x60FF, 0, 3'000);
  drive.wait(6'000);
  drive.put(0x60FF, 0, 0);
  const Stop stop = drive.watch(6'000);
  EXPECT_FALSE(stop.fault);
  EXPECT_LT(stop.highest_supply, 27.0);
  EXPECT_LE(std::abs(stop.final_rpm), kStanding);
}

}  // namespace
}  // namespace stator::devices
