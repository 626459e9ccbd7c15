// Profile position with the real motor: windows, relative moves, software limits, resolution.

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "devices/tmcm_3315_damped_axis.hpp"
#include "devices/tmcm_3315_module.hpp"

namespace stator::devices {
namespace {

constexpr std::uint16_t kTargetReached = 0x0400;
constexpr std::uint16_t kInternalLimit = 0x0800;

class Tmcm3315Positioning : public Tmcm3315Module {
 protected:
  Tmcm3315Positioning() : Tmcm3315Module(damped_axis()) {
    go_operational();
    write<std::uint8_t>(0x2004, 128);  // holds at rest as in motion
    set_profile(0, 100'000, 1'000'000);
  }
  bool target_reached() { return (statusword() & kTargetReached) != 0; }
  bool limited() { return (statusword() & kInternalLimit) != 0; }
  std::int32_t demand() { return bus_->upload<std::int32_t>(0x6062); }
  /// Pushes the standing shaft about 100 microsteps away, without a step being lost.
  void push(bool on) { device_->axis(0).plant().set_external_torque(on ? -0.3 : 0.0); }
  void start_relative(std::int32_t distance) {
    write<std::int32_t>(0x607A, distance);
    control(0, 0x005F);
    control(0, 0x004F);
  }
};

// Target reached

TEST_F(Tmcm3315Positioning, WithAWindowOfZeroOrWithoutOneTheDemandDecides) {
  use_encoder();
  write<std::uint16_t>(0x6068, 200);
  enable(0, 1);
  for (const std::uint32_t window : {0xFFFFFFFFU, 0U}) {
    write<std::uint32_t>(0x6067, window);
    start_move(0, 5000);
    EXPECT_FALSE(target_reached()) << window;
    push(true);
    bus_->pass(150_ms);
    EXPECT_EQ(demand(), 5000);
    EXPECT_LT(bus_->upload<std::int32_t>(0x6064), 4970);
    EXPECT_TRUE(target_reached()) << window << ": neither actual position nor time matter";
    push(false);
    start_move(0, 0);
    bus_->pass(150_ms);
  }
}

TEST_F(Tmcm3315Positioning, LeavingTheWindowClearsTheBitAndRestartsTheTime) {
  use_encoder();
  write<std::uint32_t>(0x6067, 30);
  write<std::uint16_t>(0x6068, 50);
  enable(0, 1);
  start_move(0, 5000);
  bus_->pass(300_ms);
  ASSERT_TRUE(target_reached());
  push(true);
  bus_->pass(100_ms);
  EXPECT_FALSE(target_reached()) << "outside";
  push(false);
  bus_->pass(35_ms);
  push(true);
  bus_->pass(30_ms);
  push(false);
  bus_->pass(40_ms);
  EXPECT_FALSE(target_reached()) << "two short stays do not add up";
  bus_->pass(100_ms);
  EXPECT_TRUE(target_reached());
}

TEST_F(Tmcm3315Positioning, AWindowWithoutTimeIsReachedBeforeTheMotorStands) {
  write<std::uint32_t>(0x6067, 3000);
  enable(0, 1);
  start_move(0, 100'000);
  while (demand() < 96'000) {
    bus_->pass(1_ms);
    ASSERT_FALSE(target_reached());
  }
  while (demand() < 97'100) {
    bus_->pass(1_ms);
  }
  EXPECT_TRUE(target_reached());
  EXPECT_NE(statusword() & 0x4000, 0) << "still moving";
}

TEST_F(Tmcm3315Positioning, AHugeWindowContainsEverything) {
  write<std::uint32_t>(0x6067, 0xFFFFFFFE);
  write<std::uint16_t>(0x6068, 20);
  enable(0, 1);
  bus_->pass(100_ms);
  EXPECT_TRUE(target_reached()) << "standing where it was enabled";
  start_move(0, std::numeric_limits<std::int32_t>::min());
  EXPECT_FALSE(target_reached()) << "the time counts from the new set-point on";
  bus_->pass(18_ms);
  EXPECT_FALSE(target_reached());
  bus_->pass(5_ms);
  EXPECT_TRUE(target_reached());
}

// Relative moves

TEST_F(Tmcm3315Positioning, RelativeMovesReferToTheBaseOf60F2) {
  struct Row {
    std::uint16_t option;
    std::int32_t base;  // after a move to 10000 whose shaft stands off by the push
  };
  use_encoder();
  enable(0, 1);
  for (const Row& row : {Row{0, 10'000}, Row{1, 10'000}, Row{2, 9'900}, Row{0xFF06, 9'900}}) {
    start_move(0, 10'000);
    bus_->pass(500_ms);
    push(true);
    bus_->pass(100_ms);
    write<std::uint16_t>(0x60F2, row.option);
    start_relative(-4000);
    bus_->pass(500_ms);
    push(false);
    if ((row.option & 3) == 2) {
      EXPECT_LT(demand(), 5970) << "actual position, which lags";
      EXPECT_GT(demand(), 5800);
    } else {
      EXPECT_EQ(demand(), row.base - 4000) << "option " << row.option;
    }
  }
}

TEST_F(Tmcm3315Positioning, PrecedingTargetAndDemandDifferInFlight) {
  enable(0, 1);
  start_move(0, 50'000);
  bus_->pass(100_ms);
  start_relative(1000);  // 60F2h = 0
  bus_->pass(2_s);
  EXPECT_EQ(demand(), 51'000);
  write<std::uint16_t>(0x60F2, 1);
  start_move(0, 0);
  bus_->pass(100_ms);
  const std::int32_t before = demand();
  start_relative(1000);
  const std::int32_t after = demand();
  bus_->pass(2_s);
  EXPECT_LE(demand(), before + 1000);
  EXPECT_GE(demand(), after + 1000 - 200) << "6062h is up to 1 ms old";
}

// Software limits

TEST_F(Tmcm3315Positioning, CorrectedLimitsBeyond32BitsLimitNothing) {
  write<std::int32_t>(0x607C, 1'000'000);
  write<std::int32_t>(0x607D, -2'147'483'647, 1);
  enable(0, 1);
  start_move(0, -2000);
  bus_->pass(500_ms);
  EXPECT_EQ(demand(), -2000);
  EXPECT_FALSE(limited());
  write<std::int32_t>(0x607C, -2'000'000'000);
  write<std::int32_t>(0x607D, std::numeric_limits<std::int32_t>::min(), 1);
  write<std::int32_t>(0x607D, 2'147'483'646, 2);
  start_move(0, 2000);
  bus_->pass(500_ms);
  EXPECT_EQ(demand(), 2000);
  EXPECT_FALSE(limited());
  EXPECT_TRUE(bus_->take_emergencies().empty());
}

TEST_F(Tmcm3315Positioning, TargetsAreClampedToTheCorrectedLimits) {
  write<std::int32_t>(0x607C, 2000);
  write<std::int32_t>(0x607D, -1000, 1);
  write<std::int32_t>(0x607D, 100'000, 2);
  enable(0, 1);
  for (const std::int32_t target : {-3001, std::numeric_limits<std::int32_t>::min()}) {
    start_move(0, target);
    bus_->pass(2_s);
    EXPECT_EQ(demand(), -3000);
    EXPECT_TRUE(limited());
    EXPECT_TRUE(target_reached());
  }
  start_move(0, -3000);
  bus_->pass(1_s);
  EXPECT_FALSE(limited()) << "the limit itself is allowed";
  start_move(0, 98'001);
  bus_->pass(3_s);
  EXPECT_EQ(demand(), 98'000);
  EXPECT_TRUE(limited());
  write<std::uint16_t>(0x60F2, 0);
  start_relative(-500);
  bus_->pass(1_s);
  EXPECT_EQ(demand(), 97'500) << "relative to the target in force";
  EXPECT_FALSE(limited());
  EXPECT_TRUE(bus_->take_emergencies().empty()) << "a clamped target never leaves the range";
}

// Following error

TEST_F(Tmcm3315Positioning, AFollowingErrorNeedsMoreThanTheWindow) {
  use_encoder();
  enable(0, 1);
  push(true);
  bus_->pass(200_ms);
  const std::int32_t deviation = demand() - bus_->upload<std::int32_t>(0x6064);
  ASSERT_GT(deviation, 50);
  write<std::uint32_t>(0x6065, static_cast<std::uint32_t>(deviation));
  bus_->pass(20_ms);
  EXPECT_EQ(statusword() & 0x006F, 0x0027) << "exactly the window: allowed";
  write<std::uint32_t>(0x6065, 0);
  bus_->pass(20_ms);
  EXPECT_EQ(statusword() & 0x006F, 0x0027) << "0: no supervision";
  write<std::uint32_t>(0x6065, static_cast<std::uint32_t>(deviation - 1));
  bus_->pass(20_ms);
  EXPECT_EQ(statusword() & 0x004F, 0x0008);
}

// Resolution

TEST_F(Tmcm3315Positioning, ARevolutionIsFullStepsTimesMicrosteps) {
  write<std::uint32_t>(0x6081, 20'000);
  write<std::uint16_t>(0x2001, 400);
  write<std::uint8_t>(0x2000, 7);
  use_encoder();
  enable(0, 1);
  start_move(0, 12'800);  // 100 full steps of the motor of 200: half a revolution
  bus_->pass(1_s);
  EXPECT_NEAR(signal("axis0.shaft_position"), 0.5, 1e-3);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x6064), 25'600, 10)
      << "half of 400 * 2^7: the encoder is scaled with what 2001h says";
  write<std::uint16_t>(0x2401, 65'535);
  EXPECT_EQ(bus_->upload<std::uint16_t>(0x2401), 65'535);
  EXPECT_EQ(bus_->upload<std::uint16_t>(0x2201), 200) << "each axis has its own";
}

TEST_F(Tmcm3315Positioning, ALiveChangeOfResolutionRescalesNoPosition) {
  use_encoder();
  write<std::uint32_t>(0x6065, 500);
  enable(0, 1);
  start_move(0, 51'200);
  bus_->pass(2_s);
  const std::int32_t actual = bus_->upload<std::int32_t>(0x6064);
  ASSERT_NEAR(actual, 51'200, 2);
  const double shaft = signal("axis0.shaft_position");
  write<std::uint8_t>(0x2000, 4);
  bus_->pass(100_ms);
  EXPECT_EQ(demand(), 51'200);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6064), actual);
  EXPECT_EQ(statusword() & 0x006F, 0x0027) << "no following error";
  write<std::uint32_t>(0x6081, 3200);
  start_move(0, 51'200 + 3200);
  bus_->pass(2_s);
  EXPECT_NEAR(signal("axis0.shaft_position") - shaft, 1.0, 0.02) << "3200 are a revolution now";
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x6064), 54'400, 20);
}

TEST_F(Tmcm3315Positioning, ALiveChangeOfResolutionLeavesTheCurrentVectorWhereItIs) {
  enable(0, 1);
  start_move(0, 12'345);
  bus_->pass(1_s);
  const std::array<double, 2> before = device_->axis(0).axis().driver().current_target();
  ASSERT_GT(std::fabs(before[0]), 0.05);
  ASSERT_GT(std::fabs(before[1]), 0.05);
  for (const int resolution : {4, 0, 8, 3}) {
    write<std::uint8_t>(0x2000, static_cast<std::uint8_t>(resolution));
    bus_->pass(20_ms);
    EXPECT_EQ(device_->axis(0).axis().driver().current_target(), before) << resolution;
    EXPECT_EQ(demand(), 12'345) << "and the position is not rescaled";
    EXPECT_EQ(bus_->upload<std::int32_t>(0x6064), 12'345);
  }
}

}  // namespace
}  // namespace stator::devices
