// Bits of the controlword that mean something in some modes of a servo axis and nothing in others.

#include <cstdint>

#include <gtest/gtest.h>

#include "drive/servo_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;

constexpr std::uint16_t kEnabled = 0x0F;
constexpr std::uint16_t kNewSetPoint = 0x1F;
constexpr std::uint16_t kHalt = 0x100;

class ServoNewSetPoint : public testing::Test {
 protected:
  ServoNewSetPoint() {
    bench_.set_profile(3000, 20'000, 20'000);
    bench_.enable(ModeCode::profile_position);
  }
  void control(std::uint16_t controlword) { bench_.write(0x6040, controlword); }
  [[nodiscard]] bool moves() const { return bench_.status(statusword::kMotorActivity); }
  [[nodiscard]] bool arrives_at(std::int64_t target) {
    return bench_.pass_until(
        [&] { return bench_.read(0x6062) == target && bench_.status(statusword::kTargetReached); },
        5_s);
  }
  ServoBench bench_;
};

TEST_F(ServoNewSetPoint, IsTakenOnTheEdgeOfBitFourAndNotOnItsLevel) {
  bench_.write(0x607A, 4000);
  control(kNewSetPoint);
  EXPECT_TRUE(arrives_at(4000));
  bench_.write(0x607A, 8000);
  control(kNewSetPoint);
  bench_.pass(200_ms);
  EXPECT_EQ(bench_.read(0x6062), 4000) << "bit 4 has been 1 all the time";
  EXPECT_TRUE(bench_.status(statusword::kSetPointAcknowledge));
  control(kEnabled);
  EXPECT_FALSE(bench_.status(statusword::kSetPointAcknowledge));
  bench_.pass(200_ms);
  EXPECT_EQ(bench_.read(0x6062), 4000) << "its fall starts nothing";
  control(kNewSetPoint);
  EXPECT_TRUE(arrives_at(8000)) << "0 lay between";
}

TEST_F(ServoNewSetPoint, MayFallWhileTheMotorMovesAndStartTheNextOne) {
  bench_.write(0x607A, 400'000);
  control(kNewSetPoint);
  bench_.pass(300_ms);
  ASSERT_TRUE(moves());
  control(kEnabled);
  const std::int64_t at_the_fall = bench_.read(0x6062);
  bench_.pass(200_ms);
  EXPECT_TRUE(moves()) << "the positioning goes on";
  EXPECT_GT(bench_.read(0x6062), at_the_fall + 20'000);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), 3000.0, 40.0);

  bench_.write(0x607A, 1000);
  bench_.pass(200_ms);
  EXPECT_GT(bench_.read(0x606C), 0) << "a target alone changes nothing";
  control(kNewSetPoint);
  EXPECT_TRUE(arrives_at(1000));
}

TEST_F(ServoNewSetPoint, ThatStaysIsNotTakenAgainInFlight) {
  bench_.write(0x607A, 60'000);
  control(kNewSetPoint);
  bench_.pass(100_ms);
  ASSERT_TRUE(moves());
  bench_.write(0x607A, -60'000);
  control(kNewSetPoint);
  EXPECT_TRUE(arrives_at(60'000));
}

class ServoTorqueControlword : public testing::Test {
 protected:
  ServoTorqueControlword() {
    bench_.set_profile(0, 10'000, 20'000);
    bench_.enable(ModeCode::cyclic_synchronous_torque);
    bench_.motor.blocked = true;
    bench_.write(0x6071, 1000);
    bench_.pass(50_ms);
  }
  /// The torque is that of the target, and nothing else has changed.
  void expect_the_target() {
    EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
    EXPECT_EQ(bench_.read(0x6061), 10);
    EXPECT_EQ(bench_.axis->controller().target_current(), 1000);
    EXPECT_NEAR(static_cast<double>(bench_.read(0x6077)), 1000.0, 20.0);
    EXPECT_TRUE(bench_.status(statusword::kTargetUsed));
  }
  ServoBench bench_;
};

TEST_F(ServoTorqueControlword, HasNoBitsOfItsModeSoFourToSixAndNineToFifteenDoNothing) {
  expect_the_target();
  const std::int64_t status = bench_.read(0x6041);
  for (const unsigned bit : {4U, 5U, 6U, 9U, 10U, 11U, 12U, 13U, 14U, 15U}) {
    SCOPED_TRACE(bit);
    for (const std::uint16_t controlword :
         {static_cast<std::uint16_t>(kEnabled | 1U << bit), kEnabled}) {
      bench_.write(0x6040, controlword);
      bench_.pass(5_ms);
      expect_the_target();
      EXPECT_EQ(bench_.read(0x6041), status);
    }
  }
  bench_.write(0x6040, kEnabled | 0xFE70);
  bench_.pass(5_ms);
  expect_the_target();
}

TEST_F(ServoTorqueControlword, HasHaltInBitEightWhateverTheUnusedBitsAre) {
  for (const std::uint16_t unused : {std::uint16_t{0}, std::uint16_t{0xFE70}}) {
    bench_.write(0x6040, kEnabled | kHalt | unused);
    bench_.pass(200_ms);
    EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
    EXPECT_NEAR(static_cast<double>(bench_.read(0x6077)), 0.0, 20.0);
    EXPECT_FALSE(bench_.status(statusword::kTargetUsed));
    bench_.write(0x6040, kEnabled | unused);
    bench_.pass(200_ms);
    expect_the_target();
  }
}

}  // namespace
}  // namespace stator::drive
