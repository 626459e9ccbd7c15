// Limits hold the shaft of a TMC8670, whatever its set-point does, and let it go when they are
// gone.

#include <limits>

#include "devices/tmc8670_cycles.hpp"

namespace stator::devices {
namespace {

class Tmc8670Limits : public Tmc8670Cycles {
 protected:
  /// The right switch is pressed from `revolutions` on.
  void cycle_with_switch(double revolutions, base::SimDuration duration) {
    for (const base::SimTime end = bus_->now() + duration; bus_->now() < end;) {
      set_input("axis0.right_switch", seen().revolutions >= revolutions ? 1.0 : 0.0);
      cycle(1_ms);
    }
  }
  [[nodiscard]] double farthest() const {
    double result = -std::numeric_limits<double>::infinity();
    for (const Sample& sample : trace_) {
      result = std::max(result, sample.revolutions);
    }
    return result;
  }
};

TEST_F(Tmc8670Limits, ALimitSwitchStopsAShaftThatFollowsAJumpOfTheCyclicTarget) {
  write<std::uint32_t>(0x6065, 0xFFFFFFFF);
  enable_in(8);
  position_ = actual() + 50 * kTurn;
  forget();
  cycle_with_switch(3.0, 1_s);
  // 4000 rpm at 20,000 rpm/s are 6.7 revolutions.
  EXPECT_LT(farthest(), 3.0 + 1.2 * 6.7 + 0.5);
  EXPECT_TRUE(has(kLimited));
  EXPECT_FALSE(has(kFollows)) << "the target is not followed";
  EXPECT_LE(std::fabs(seen().rpm), kStands);
}

TEST_F(Tmc8670Limits, ALimitSwitchStopsAShaftThatLagsForWantOfTorque) {
  write<std::uint32_t>(0x6065, 0xFFFFFFFF);
  write<std::uint16_t>(0x6072, 100);
  enable_in(1);
  move_to(60 * kTurn);
  forget();
  cycle_with_switch(3.0, 6_s);
  EXPECT_LT(farthest(), 8.0) << "as far as it took to gain the speed, and friction helps";
  EXPECT_TRUE(has(kLimited));
  EXPECT_LE(std::fabs(seen().rpm), kStands);
}

TEST_F(Tmc8670Limits, ACyclicVelocityGoesOnWhenTheSwitchIsReleased) {
  enable_in(9);
  velocity_ = 1000;
  cycle(300_ms);
  ASSERT_NEAR(seen().rpm, 1000.0, 20.0);
  set_input("axis0.right_switch", 1.0);
  cycle(20_ms);
  EXPECT_TRUE(has(kLimited));
  EXPECT_FALSE(has(kFollows));
  set_input("axis0.right_switch", 0.0);
  forget();
  cycle(500_ms);
  EXPECT_NEAR(seen().rpm, 1000.0, 20.0);
  EXPECT_FALSE(has(kLimited));
  EXPECT_TRUE(has(kFollows));
  EXPECT_LE(steepest(), 1.3 * 20'000.0) << "on the ramp of 6083h";
}

TEST_F(Tmc8670Limits, AWidenedSoftwareLimitIsGoneToOnTheProfile) {
  write<std::uint32_t>(0x6065, 0xFFFFFFFF);
  write<std::uint32_t>(0x607F, 1000);
  write<std::int32_t>(0x607D, -1000 * kTurn, 1);
  write<std::int32_t>(0x607D, 1 * kTurn, 2);
  enable_in(8);
  position_ = actual();
  for (int k = 0; k < 1000; ++k) {  // to ten turns, at 600 rpm
    position_ += 655;
    cycle(1_ms);
  }
  EXPECT_NEAR(seen().revolutions, 1.0, 0.05);
  EXPECT_TRUE(has(kLimited));
  write<std::int32_t>(0x607D, 100 * kTurn, 2);
  forget();
  cycle(2_s);
  EXPECT_NEAR(seen().revolutions, 655'000.0 / kTurn, 0.05) << "the same target, without another";
  EXPECT_LE(fastest(), 1.1 * 1000.0) << "607Fh";
  EXPECT_LE(steepest(), 1.3 * 20'000.0);
  EXPECT_FALSE(has(kLimited));
}

TEST_F(Tmc8670Limits, ARaisedProfileVelocityActsOnTheTargetThatIsThere) {
  write<std::uint32_t>(0x607F, 500);
  enable_in(9);
  velocity_ = 1500;
  cycle(300_ms);
  EXPECT_NEAR(seen().rpm, 500.0, 20.0);
  write<std::uint32_t>(0x607F, 4000);
  forget();
  cycle(300_ms);
  EXPECT_NEAR(seen().rpm, 1500.0, 30.0);
  EXPECT_LE(steepest(), 1.3 * 20'000.0);
}

TEST_F(Tmc8670Limits, ATorqueGoesOnWhenTheSwitchIsReleased) {
  for (const std::int8_t mode : {std::int8_t{4}, std::int8_t{10}}) {
    SCOPED_TRACE(int{mode});
    renew(servo());
    go_operational();
    write<std::uint32_t>(0x6087, 100'000);
    torque_ = 0;
    enable_in(mode);
    torque_ = 100;
    cycle(50_ms);
    set_input("axis0.right_switch", 1.0);
    cycle(500_ms);
    EXPECT_TRUE(has(kLimited));
    EXPECT_LE(std::fabs(seen().rpm), kStands);
    const double stood = seen().revolutions;
    set_input("axis0.right_switch", 0.0);
    cycle(300_ms);
    EXPECT_GT(seen().revolutions, stood + 0.5) << "with the torque that was there all the time";
  }
}

TEST_F(Tmc8670Limits, NoTorqueLetsNothingThroughASwitch) {
  write<std::uint32_t>(0x6087, 100'000);
  enable_in(10);
  torque_ = 100;
  cycle(50_ms);
  set_input("axis0.right_switch", 1.0);
  cycle(500_ms);
  const double stood = seen().revolutions;
  torque_ = 0;
  set_input("axis0.load_torque", 0.02);
  cycle(2_s);
  EXPECT_NEAR(seen().revolutions, stood, 0.2) << "a load that drives outward is held";
}

}  // namespace
}  // namespace stator::devices
