// Cyclic synchronous position and velocity: interpolation, streams of set-points, lost ones.

#include <cstdint>
#include <vector>

#include "devices/tmcm_3315_modes.hpp"

namespace stator::devices {
namespace {

TEST_F(Tmcm3315Modes, EveryInterpolationIndexScalesTheVelocityOfCsp) {
  enable(0, 8);
  std::int32_t target = 0;
  double period = 0.005;
  for (std::int8_t index = -3; index <= 3; ++index, period *= 10.0) {
    set_interpolation(5, index);
    target += 1000;
    const double expected = (target - position()) / period;
    write<std::int32_t>(0x607A, target);
    bus_->pass(2_ms);
    EXPECT_NEAR(velocity(), expected, 1e-2 * expected) << "index " << int{index};
  }
}

TEST_F(Tmcm3315Modes, EveryInterpolationIndexScalesTheAccelerationOfCsv) {
  double period = 0.005;
  for (std::int8_t index = -3; index <= 3; ++index, period *= 10.0) {
    control(0, 0);
    write<std::int32_t>(0x60FF, 0);
    set_interpolation(5, index);
    enable(0, 9);
    write<std::int32_t>(0x60FF, 1'000'000);
    const double start = velocity();
    bus_->pass(2_ms);
    EXPECT_NEAR(velocity() - start, 1e6 * 0.002 / period, 1e6 * 0.00006 / period)
        << "index " << int{index};
  }
}

TEST_F(Tmcm3315Modes, AnInterpolationTimeOfZeroIsTakenAsOne) {
  set_interpolation(0, -3);
  enable(0, 8);
  write<std::int32_t>(0x607A, 100);
  bus_->pass(500_us);
  EXPECT_GT(velocity(), 90'000.0);
  bus_->pass(2_ms);
  EXPECT_EQ(position(), 100.0);
}

class Tmcm3315CyclicStream : public Tmcm3315Modes {
 protected:
  void start_stream(std::int8_t mode) {
    bus_->bring_to(AlState::pre_operational);
    write<std::int8_t>(0x6060, mode);
    bus_->bring_to(AlState::operational);
    for (const int controlword : {6, 7, 15}) {
      send(static_cast<std::uint16_t>(controlword), 0);
    }
  }
  /// One bus cycle of 1 ms with the set-point of csp and csv alike.
  void send(std::uint16_t controlword, std::int32_t set_point) {
    base::store_le(bus_->outputs, 0, controlword);
    base::store_le(bus_->outputs, 2, set_point);
    base::store_le(bus_->outputs, 6, set_point);
    bus_->exchange();
    bus_->pass(980_us);  // and 20 us in the frames
  }
};

TEST_F(Tmcm3315CyclicStream, LostSetPointsOfCspAreHeldAndCaughtUpInOnePeriod) {
  start_stream(8);
  for (int k = 1; k <= 100; ++k) {
    send(15, 20 * k);
  }
  EXPECT_NEAR(position(), 2000.0, 1.0);
  bus_->pass(5_ms);  // five cycles lost
  EXPECT_EQ(position(), 2000.0) << "held, not extrapolated";
  EXPECT_EQ(velocity(), 0.0);
  send(15, 2120);
  EXPECT_NEAR(position(), 2120.0, 2.0) << "six steps at once";
  send(15, 2140);
  EXPECT_NEAR(position(), 2140.0, 1.0);
  EXPECT_EQ(device_->stack().state(), AlState::operational);
}

TEST_F(Tmcm3315CyclicStream, ALateSetPointOfCspIsReachedAPeriodAfterItCame) {
  start_stream(8);
  for (int k = 1; k <= 100; ++k) {
    send(15, 20 * k);
  }
  bus_->pass(300_us);
  send(15, 2020);
  bus_->pass(200_us);
  EXPECT_EQ(position(), 2020.0);
}

TEST_F(Tmcm3315CyclicStream, TheSameSetPointOfCspAgainHoldsThePosition) {
  start_stream(8);
  send(15, 50);
  for (int i = 0; i < 20; ++i) {
    send(15, 50);
    EXPECT_NEAR(position(), 50.0, 1.0);
  }
  EXPECT_EQ(position(), 50.0);
  EXPECT_EQ(velocity(), 0.0);
}

TEST_F(Tmcm3315CyclicStream, LostSetPointsOfCsvKeepTheVelocity) {
  start_stream(9);
  for (int k = 1; k <= 50; ++k) {
    send(15, 100 * k);
  }
  bus_->pass(20_ms);
  EXPECT_NEAR(velocity(), 5000.0, 1e-6);
  send(15, 4000);
  bus_->pass(1_ms);
  EXPECT_NEAR(velocity(), 4000.0, 1e-6);
}

TEST_F(Tmcm3315CyclicStream, OffsetsAreAddedInBothCyclicModes) {
  start_stream(8);
  write<std::int32_t>(0x60B0, -300);
  bus_->pass_cyclically(5_ms);
  EXPECT_EQ(position(), -300.0) << "an offset alone is a new set-point";
  send(15, 1000);
  bus_->pass_cyclically(5_ms);
  EXPECT_EQ(position(), 700.0);
  write<std::int8_t>(0x6060, 9);
  send(15, 1000);
  write<std::int32_t>(0x60B1, -2500);
  bus_->pass_cyclically(5_ms);
  EXPECT_EQ(velocity(), -1500.0);
}

TEST_F(Tmcm3315CyclicStream, SetPointsDuringHaltAreIgnoredAndTheLatestCountsAfterwards) {
  start_stream(8);
  send(15, 100);
  send(15, 100);
  send(0x010F, 200);
  send(0x010F, 300);
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->inputs, 0) & 0x1000, 0);
  const double halted = position();
  EXPECT_LT(halted, 130.0);
  send(0x010F, 400);
  EXPECT_EQ(position(), halted);
  send(0x000F, 400);
  bus_->pass_cyclically(3_ms);
  EXPECT_EQ(position(), 400.0);
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->inputs, 0) & 0x1000, 0x1000);
}

/// 20 revolutions within 10 ms are 102 million pps; the ramp generator holds 8388607.
class Tmcm3315CyclicJump : public Tmcm3315Modes {
 protected:
  static constexpr double kDeceleration = 4e6;  // pps/s
  static constexpr double kRampTime = 8'388'607.0 / kDeceleration;

  void jump() {
    renew(damped_axis());
    go_operational();
    for (const unsigned ramp : {0x6083U, 0x6084U, 0x6085U, 0x2014U}) {
      write<std::uint32_t>(static_cast<std::uint16_t>(ramp),
                           static_cast<std::uint32_t>(kDeceleration));
    }
    set_interpolation(10, -3);
    enable(0, 8);
    bus_->pass(20_ms);
    bus_->take_emergencies();
    write<std::int32_t>(0x607A, 20 * static_cast<std::int32_t>(kMicrostepsPerRevolution));
    bus_->pass(5_ms);
    ASSERT_NEAR(velocity(), 102.4e6, 1.0);
  }
  void expect_rest_after_the_ramp() {
    const double before = position();
    bus_->pass(base::SimDuration(static_cast<std::int64_t>(0.95e9 * kRampTime)));
    EXPECT_GT(velocity(), 0.0) << "it is a ramp";
    bus_->pass(base::SimDuration(static_cast<std::int64_t>(0.06e9 * kRampTime)) + 5_ms);
    EXPECT_EQ(velocity(), 0.0);
    EXPECT_LT(position() - before, 1.05 * 0.5 * 8'388'607.0 * kRampTime);
    bus_->pass(1_s);
    EXPECT_EQ(velocity(), 0.0);
    EXPECT_EQ(bus_->take_emergencies(), std::vector<Emergency>());
  }
};

TEST_F(Tmcm3315CyclicJump, EveryStopEndsWithTheRampOfTheLargestVelocity) {
  struct Stop {
    const char* name;
    std::uint16_t controlword;
  };
  for (const Stop& stop :
       {Stop{"halt", 0x010F}, Stop{"quick stop", 0x000B}, Stop{"disable operation", 7}}) {
    SCOPED_TRACE(stop.name);
    jump();
    control(0, stop.controlword);
    expect_rest_after_the_ramp();
  }
}

TEST_F(Tmcm3315CyclicJump, AnotherModeTakesOverAfterTheRampOfTheLargestVelocity) {
  for (const std::int8_t mode : {std::int8_t{0}, std::int8_t{1}, std::int8_t{9}}) {
    SCOPED_TRACE(int{mode});
    jump();
    write<std::int8_t>(0x6060, mode);
    expect_rest_after_the_ramp();
    EXPECT_EQ(mode_display(), mode);
  }
}

TEST_F(Tmcm3315CyclicJump, TheNetworkEndsItWithTheRampOfTheLargestVelocity) {
  for (const AlState state : {AlState::safe_operational, AlState::init}) {
    jump();
    bus_->request(state);
    const double before = position();
    bus_->pass(base::SimDuration(static_cast<std::int64_t>(1.01e9 * kRampTime)) + 5_ms);
    EXPECT_EQ(velocity(), 0.0);
    EXPECT_LT(position() - before, 1.05 * 0.5 * 8'388'607.0 * kRampTime);
  }
}

TEST_F(Tmcm3315CyclicJump, AFaultIsToldOnceAndEndsWithTheRampOfTheLargestVelocity) {
  renew(damped_axis());
  go_operational();
  use_encoder(0, 51'200);
  write<std::uint32_t>(0x6065, 20'000);
  write<std::int16_t>(0x605E, 2);
  write<std::uint32_t>(0x6085, static_cast<std::uint32_t>(kDeceleration));
  set_interpolation(10, -3);
  enable(0, 8);
  bus_->pass(20_ms);
  bus_->take_emergencies();
  write<std::int32_t>(0x607A, 20 * static_cast<std::int32_t>(kMicrostepsPerRevolution));
  bus_->pass(1_ms + base::SimDuration(static_cast<std::int64_t>(1.01e9 * kRampTime)) + 5_ms);
  EXPECT_EQ(velocity(), 0.0);
  EXPECT_EQ(bus_->take_emergencies(), std::vector<Emergency>({{0x11, 0x86, 0x21, 0, 0}}));
  EXPECT_EQ(statusword() & 0x004F, 0x0008);
}

TEST_F(Tmcm3315Modes, ASoftwareLimitPutBeforeACyclicTargetUnderWayIsStoodOn) {
  run_in(8);
  const auto limit = static_cast<std::int32_t>(position()) + 3'000;
  write<std::int32_t>(0x607D, limit, 2);
  for (int i = 0; i < 20; ++i) {
    bus_->pass(50_ms);
    EXPECT_LE(position(), limit);
    EXPECT_EQ(statusword() & 0x1800, 0x0800) << "limited, the target is not followed";
  }
  EXPECT_EQ(position(), limit);
  EXPECT_EQ(velocity(), 0.0);
  write<std::int32_t>(0x607D, limit + 5'000, 2);
  bus_->pass(2_s);
  EXPECT_EQ(position(), limit + 5'000);
}

}  // namespace
}  // namespace stator::devices
