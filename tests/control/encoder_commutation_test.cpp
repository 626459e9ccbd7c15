// Commutation by an encoder, and its initialisation by alignment, by Hall sensors and by the N
// pulse.
#include "stator/control/servo/encoder_commutation.hpp"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

namespace stator::control {
namespace {

double turns(ElectricalAngle angle) {
  return static_cast<double>(angle.value) / 4294967296.0;
}

/// Signed difference of two turns, -0.5 .. 0.5.
double off_by(double a, double b) {
  return (a - b) - std::round(a - b);
}

class Encoder : public testing::Test {
 protected:
  Encoder() { settings_.commutation = ServoCommutation::encoder; }
  void configure() { encoder_.configure(settings_); }
  void pass(int milliseconds) {
    for (int k = 0; k < milliseconds; ++k) {
      encoder_.pass_millisecond(seen_);
    }
  }
  ServoControllerSettings settings_;
  EncoderCommutation encoder_;
  EncoderCommutation::Observation seen_;
};

TEST_F(Encoder, AngleIsCountPlusOffsetTimesPolePairsPerRevolution) {
  for (const int steps : {4000, 4096, 65535, 1, 1999, 7}) {
    for (const int pole_pairs : {1, 4, 7, 127}) {
      settings_.encoder_steps = static_cast<std::uint16_t>(steps);
      settings_.pole_pairs = static_cast<std::uint8_t>(pole_pairs);
      settings_.encoder_offset = 123;
      EncoderCommutation encoder;
      encoder.configure(settings_);
      for (const std::int64_t count : {0LL, 1LL, -1LL, 1000LL, -99'999LL, 3'000'000'017LL}) {
        encoder.note(count);
        const std::int64_t whole = ((count + 123) % steps) * pole_pairs % steps;
        const double expected = static_cast<double>(whole) / steps;
        ASSERT_NEAR(off_by(turns(encoder.angle()), expected), 0.0, 1e-9)
            << steps << " " << pole_pairs << " " << count;
      }
    }
  }
}

TEST_F(Encoder, DirectionTurnsCountAndAngle) {
  settings_.encoder_reversed = true;
  configure();
  encoder_.note(100);
  EXPECT_EQ(encoder_.count(), -100);
  EXPECT_NEAR(off_by(turns(encoder_.angle()), -0.1), 0.0, 1e-9);
}

TEST_F(Encoder, HallModeTakesTheAngleAndCorrectsItAtTheFirstEdge) {
  settings_.init_mode = EncoderInitMode::hall;
  configure();
  encoder_.note(500);
  seen_.hall_valid = true;
  seen_.hall_angle = angle_of_turns(1.0 / 6.0);
  encoder_.start(seen_);
  EXPECT_TRUE(encoder_.initialised());
  EXPECT_NEAR(off_by(turns(encoder_.angle()), 1.0 / 6.0), 0.0, 0.0006);  // half an encoder step
  encoder_.note(560);
  encoder_.correct_at_hall_edge(angle_of_turns(0.25));
  EXPECT_NEAR(off_by(turns(encoder_.angle()), 0.25), 0.0, 0.0006);
  encoder_.note(700);
  encoder_.correct_at_hall_edge(angle_of_turns(0.9));  // only the first one counts
  EXPECT_NEAR(off_by(turns(encoder_.angle()), 0.25 + 0.14), 0.0, 0.0006);
}

TEST_F(Encoder, HallModeFailsWithoutAValidCode) {
  settings_.init_mode = EncoderInitMode::hall;
  configure();
  encoder_.start(seen_);
  EXPECT_TRUE(encoder_.failed());
  EXPECT_FALSE(encoder_.initialised());
}

TEST_F(Encoder, AlignModeSetsTheOffsetSoThatTheFieldsAngleIsZero) {
  settings_.init_mode = EncoderInitMode::align;
  settings_.init_delay = 100;
  configure();
  const EncoderCommutation::Field begin = encoder_.start(seen_);
  EXPECT_EQ(begin.angle.object_value(), -16384);
  EXPECT_NEAR(turns(begin.step) * 25 * 20, 0.25, 1e-6) << "a quarter turn in a quarter of 100 ms";
  pass(24);
  EXPECT_TRUE(encoder_.pass_millisecond(seen_));
  EXPECT_EQ(encoder_.field().angle.value, 0U);
  EXPECT_EQ(encoder_.field().step.value, 0U);
  encoder_.note(-1234);
  seen_.current_flows = true;
  pass(74);
  EXPECT_TRUE(encoder_.initialising());
  pass(1);
  EXPECT_TRUE(encoder_.initialised());
  EXPECT_EQ(encoder_.angle().value, 0U);
  EXPECT_EQ(encoder_.offset(), 1234);
}

TEST_F(Encoder, AlignModeFailsWhenNoCurrentFlows) {
  settings_.init_mode = EncoderInitMode::align;
  settings_.init_delay = 10;
  configure();
  encoder_.start(seen_);
  pass(10);
  EXPECT_TRUE(encoder_.failed());
}

TEST_F(Encoder, IndexModeCountsTheOffsetFromTheNPulse) {
  settings_.init_mode = EncoderInitMode::index;
  settings_.init_velocity = -60;
  settings_.encoder_offset = 250;
  configure();
  const EncoderCommutation::Field field = encoder_.start(seen_);
  EXPECT_NEAR(off_by(turns(field.step), -4.0 / 20'000.0), 0.0, 1e-9);
  pass(500);
  EXPECT_TRUE(encoder_.initialising());
  seen_.index_passages = 1;
  seen_.index_count = -777;
  encoder_.note(-780);
  pass(1);
  EXPECT_TRUE(encoder_.initialised());
  EXPECT_NEAR(off_by(turns(encoder_.angle()), (250.0 - 3.0) * 4.0 / 4000.0), 0.0, 1e-9);
  EXPECT_EQ(encoder_.offset(), 250);
}

TEST_F(Encoder, IndexModeFailsAfterThreeRevolutionsOrWithoutVelocity) {
  settings_.init_mode = EncoderInitMode::index;
  settings_.init_velocity = 60;
  configure();
  encoder_.start(seen_);
  pass(3000);
  EXPECT_TRUE(encoder_.initialising());
  pass(1);
  EXPECT_TRUE(encoder_.failed());
  settings_.init_velocity = 0;
  configure();
  encoder_.start(seen_);
  EXPECT_TRUE(encoder_.failed());
}

TEST_F(Encoder, AChangedOffsetActsAtOnceAndAChangedResolutionNeedsANewInitialisation) {
  settings_.init_mode = EncoderInitMode::hall;
  configure();
  seen_.hall_valid = true;
  encoder_.start(seen_);
  settings_.encoder_offset = 250;
  configure();
  EXPECT_TRUE(encoder_.initialised());
  EXPECT_NEAR(turns(encoder_.angle()), 0.25, 1e-9);
  settings_.encoder_steps = 8000;
  configure();
  EXPECT_FALSE(encoder_.initialised());
}

}  // namespace
}  // namespace stator::control
