// Ramp shapes as the objects of an axis choose them; the profiles themselves are tested in control.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "drive/axis_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;

class RampShapes : public testing::Test {
 protected:
  RampShapes() { bench_.set_profile(10'000, 20'000, 40'000); }
  void choose_bows(std::int64_t jerk) {
    bench_.write(0x6086, 1);
    for (std::uint8_t i = 1; i <= 4; ++i) {
      bench_.write(0x60A4, i, jerk);
    }
  }
  void move_to(std::int64_t target) {
    bench_.write(0x607A, target);
    bench_.write(0x6040, 0x1F);
    bench_.write(0x6040, 0x0F);
  }
  [[nodiscard]] const control::RampGenerator& ramp() const { return bench_.axis->motion().ramp(); }
  /// Largest change of acceleration per second while `duration` passes.
  double largest_jerk(base::SimDuration duration) {
    constexpr base::SimDuration kStep = 50_us;
    double largest = 0.0;
    for (base::SimDuration passed; passed < duration; passed += kStep) {
      const double before = ramp().acceleration();
      bench_.pass(kStep);
      largest = std::max(largest, std::fabs(ramp().acceleration() - before) / kStep.seconds());
    }
    return largest;
  }
  AxisBench bench_;
};

TEST_F(RampShapes, ObjectsSelectShapeAndJerksOfBothProfileModes) {
  choose_bows(100'000);
  bench_.axis->settings().ramp.bow_factor = 3.0;
  for (const ModeCode mode : {ModeCode::profile_position, ModeCode::profile_velocity}) {
    bench_.write(0x6040, 0);
    bench_.enable(mode);
    bench_.write(0x60FF, -10'000);
    move_to(100'000);
    EXPECT_EQ(ramp().limits().shape, control::RampShape::s_shaped);
    bench_.pass(20_ms);
    EXPECT_NEAR(std::fabs(ramp().acceleration()), 6'000.0, 1e-6);
    EXPECT_NEAR(std::fabs(ramp().velocity()), 60.0, 1e-6);
  }
}

TEST_F(RampShapes, JerksAreNotUsedByLinearRamps) {
  choose_bows(100'000);
  bench_.write(0x6086, 0);
  bench_.enable(ModeCode::profile_position);
  move_to(100'000);
  bench_.pass(20_ms);
  EXPECT_EQ(ramp().acceleration(), 20'000.0);
}

TEST_F(RampShapes, EndVelocityAndStopDecelerationActInPositioning) {
  bench_.write(0x6082, 1'000);
  bench_.enable(ModeCode::profile_position);
  move_to(5'000);
  double before = 0.0;
  while (ramp().velocity() != 0.0 || before == 0.0) {
    before = ramp().velocity();
    bench_.pass(50_us);
  }
  EXPECT_NEAR(before, 1'000.0, 2.0);
  EXPECT_EQ(bench_.position(), 5'000.0);
  bench_.axis->settings().ramp.stop_deceleration = 100'000.0;
  move_to(0);
  bool stops = false;
  while (bench_.position() != 0.0) {
    bench_.pass(50_us);
    stops = stops || ramp().acceleration() == 100'000.0;
  }
  EXPECT_TRUE(stops);
}

TEST_F(RampShapes, EndVelocityHasNoMeaningInVelocityMode) {
  bench_.write(0x6082, 1'000);
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, 10'000);
  bench_.pass(1_s);
  bench_.write(0x60FF, 0);
  bench_.pass(245_ms);
  EXPECT_NEAR(bench_.velocity(), 200.0, 1e-6);
}

TEST_F(RampShapes, HaltBrakesWithBowsAndTheMoveGoesOn) {
  choose_bows(400'000);
  bench_.enable(ModeCode::profile_position);
  move_to(100'000);
  bench_.pass(1_s);
  bench_.write(0x6040, 0x010F);
  EXPECT_LE(largest_jerk(400_ms), 400'000.0 * 1.001);
  EXPECT_EQ(bench_.velocity(), 0.0);
  EXPECT_TRUE(bench_.status(statusword::kTargetReached)) << "during halt: the axis stands";
  bench_.write(0x6040, 0x000F);
  EXPECT_LE(largest_jerk(15_s), 400'000.0 * 1.001);
  EXPECT_EQ(bench_.position(), 100'000.0);
}

TEST_F(RampShapes, QuickStopOnTheSlowDownRampHasBowsAndOnItsOwnRampNone) {
  choose_bows(400'000);
  bench_.write(0x6085, 80'000);
  bench_.enable(ModeCode::profile_velocity);
  for (const int option : {5, 6}) {
    bench_.write(0x605A, option);
    bench_.write(0x60FF, 10'000);
    bench_.write(0x6040, 0x000F);
    bench_.pass(2_s);
    ASSERT_EQ(bench_.velocity(), 10'000.0);
    bench_.write(0x6040, 0x0002);
    bench_.pass(1_ms);
    const double expected = option == 5 ? -400.0 : -80'000.0;
    EXPECT_NEAR(ramp().acceleration(), expected, 1.0) << option;
    bench_.pass(1_s);
    EXPECT_EQ(bench_.velocity(), 0.0);
  }
}

TEST_F(RampShapes, AChangeOfShapeActsInFlight) {
  bench_.enable(ModeCode::profile_position);
  move_to(50'000);
  bench_.pass(250_ms);
  choose_bows(400'000);
  bench_.pass(1_ms);
  EXPECT_NEAR(bench_.velocity(), 5'020.0, 25.0);
  EXPECT_LT(ramp().acceleration(), 1'000.0) << "a bow begins";
  bench_.pass(500_ms);
  bench_.write(0x6086, 0);
  bench_.pass(20_s);
  EXPECT_EQ(bench_.position(), 50'000.0);
}

TEST_F(RampShapes, JerksActInFlight) {
  choose_bows(100'000);
  bench_.enable(ModeCode::profile_position);
  move_to(1'000'000);
  bench_.pass(50_ms);
  bench_.write(0x60A4, 1, 10'000);
  bench_.pass(1_ms);
  const double before = ramp().acceleration();
  bench_.pass(10_ms);
  EXPECT_NEAR(ramp().acceleration() - before, 100.0, 1e-6);
}

TEST_F(RampShapes, BowsStopExactlyAtASoftwareLimitFromAnySpeedAndAcceleration) {
  choose_bows(200'000);
  bench_.enable(ModeCode::profile_velocity);
  std::int64_t limit = 0;
  for (const int lead : {50, 300, 1'000, 3'000, 5'000, 9'000, 20'000}) {
    limit += lead;
    bench_.write(0x607D, 2, limit);
    bench_.write(0x60FF, 10'000);
    double furthest = 0.0;
    for (int tick = 0; tick < 8'000; ++tick) {
      bench_.pass(1_ms);
      furthest = std::max(furthest, bench_.position());
    }
    EXPECT_EQ(furthest, static_cast<double>(limit));
    EXPECT_EQ(bench_.position(), static_cast<double>(limit));
    EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  }
}

TEST_F(RampShapes, ReversingInFrontOfASoftwareLimitIsNotCutShort) {
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x607D, 2, 20'000);
  bench_.write(0x60FF, 10'000);
  while (bench_.position() < 20'000.0 - 1'250.0 - 30.0) {
    bench_.pass(50_us);
  }
  bench_.write(0x60FF, -5'000);
  bench_.pass(2_s);
  EXPECT_EQ(bench_.velocity(), -5'000.0);
}

TEST_F(RampShapes, VelocitiesAndAccelerationsAreClippedToWhatTheRampGeneratorHolds) {
  bench_.set_profile(4'294'967'295, 4'294'967'295, 4'294'967'295);
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, 2'147'483'647);
  bench_.pass(3_s);
  EXPECT_EQ(bench_.velocity(), 8'388'607.0);
  EXPECT_TRUE(bench_.status(statusword::kTargetReached));
  EXPECT_EQ(ramp().limits().acceleration, 4'194'303.0);
  EXPECT_EQ(MotionUnits::jerk(2'147'483'647.0, 255.0), 476.837e9);
}

}  // namespace
}  // namespace stator::drive
