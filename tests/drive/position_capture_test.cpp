#include "stator/drive/motion/position_capture.hpp"

#include <gtest/gtest.h>

#include "stator/base/axis_signals.hpp"

namespace stator::drive {
namespace {

/// An encoder with one mark at count 100, seen once per step.
class PositionCaptureTest : public testing::Test {
 protected:
  static constexpr std::int64_t kMark = 100;

  /// Moves to `count`; N is low at the mark if `active_low`.
  void move_to(std::int64_t count, bool active_low = false) {
    const std::int64_t before = sensing_.encoder_count;
    sensing_.encoder_count = count;
    const bool meets = (before < kMark && count >= kMark) || (before > kMark && count <= kMark);
    if (meets) {
      ++sensing_.encoder_index_passages;
      sensing_.encoder_index_count = kMark;
    }
    sensing_.encoder_index = (count == kMark) != active_low;
    capture_.observe(reference_signals(sensing_), settings_, index_used_, 10 * count);
  }
  [[nodiscard]] std::int64_t count() const {
    return capture_.captured() ? capture_.captured()->encoder_count : -1;
  }

  PositionCapture capture_;
  base::AxisSensing sensing_;
  ReferenceSettings settings_;
  bool index_used_ = true;
};

TEST_F(PositionCaptureTest, HoldsTheIndexToTheCountHoweverFastTheShaft) {
  for (const std::int64_t end : {100, 101, 190}) {
    move_to(90);
    capture_.arm_index();
    move_to(91);
    EXPECT_TRUE(capture_.armed());
    move_to(end);
    EXPECT_FALSE(capture_.armed());
    EXPECT_EQ(count(), kMark);
    EXPECT_EQ(capture_.captured()->motor_microsteps, 10 * end) << "within one step";
    move_to(300);
    EXPECT_EQ(count(), kMark) << "held";
  }
}

TEST_F(PositionCaptureTest, HoldsTheIndexInBothDirections) {
  move_to(120);
  capture_.arm_index();
  move_to(119);
  move_to(80);
  EXPECT_EQ(count(), kMark);
}

TEST_F(PositionCaptureTest, TheIndexTheEncoderStandsOnDoesNotCount) {
  move_to(100);
  capture_.arm_index();
  move_to(100);
  move_to(101);
  move_to(150);
  EXPECT_TRUE(capture_.armed());
  move_to(99);
  EXPECT_EQ(count(), kMark);
}

TEST_F(PositionCaptureTest, PolarityMakesAnActiveLowIndexFitting) {
  settings_.index_active_low = true;
  move_to(90, true);
  capture_.arm_index();
  move_to(91, true);
  move_to(150, true);
  EXPECT_EQ(count(), kMark);
}

TEST_F(PositionCaptureTest, WrongPolarityTakesTheOtherEdgeOfTheIndex) {
  move_to(90, true);
  capture_.arm_index();
  move_to(91, true);
  move_to(100, true);
  EXPECT_TRUE(capture_.armed()) << "the mark looks inactive";
  move_to(130, true);
  EXPECT_EQ(count(), kMark + 1);
  capture_.arm_index();
  move_to(130, true);
  move_to(60, true);
  EXPECT_EQ(count(), kMark - 1) << "the mark was crossed within one step";
}

TEST_F(PositionCaptureTest, WithoutAnEncoderNoIndexEverComes) {
  index_used_ = false;
  move_to(90);
  capture_.arm_index();
  move_to(91);
  move_to(200);
  EXPECT_TRUE(capture_.armed());
}

TEST_F(PositionCaptureTest, HoldsWhereASwitchIsReleased) {
  capture_.arm_release(ReferenceSwitch::home, false);
  move_to(5);
  EXPECT_TRUE(capture_.armed()) << "it was not pressed yet";
  sensing_.home_switch = true;
  move_to(6);
  move_to(7);
  sensing_.left_switch = true;
  sensing_.home_switch = false;
  move_to(8);
  EXPECT_EQ(count(), 8);
  EXPECT_EQ(capture_.captured()->motor_microsteps, 80);
}

TEST_F(PositionCaptureTest, AnIndexCountsFromTheReleaseOn) {
  capture_.arm_release(ReferenceSwitch::positive_limit, true);
  sensing_.right_switch = true;
  move_to(90);
  move_to(110);
  sensing_.right_switch = false;
  move_to(120);
  EXPECT_TRUE(capture_.armed()) << "the mark lies under the switch";
  move_to(90);
  EXPECT_EQ(count(), kMark);
}

TEST_F(PositionCaptureTest, ATakenOrDisarmedCaptureIsGone) {
  move_to(90);
  capture_.arm_index();
  move_to(91);
  capture_.disarm();
  move_to(150);
  EXPECT_FALSE(capture_.captured());
  capture_.arm_index();
  move_to(151);
  move_to(50);
  EXPECT_TRUE(capture_.take());
  EXPECT_FALSE(capture_.take());
  capture_.arm_index();
  move_to(51);
  move_to(150);
  capture_.disarm();
  EXPECT_FALSE(capture_.captured());
}

}  // namespace
}  // namespace stator::drive
