// Closed-loop operation of a stepper as the TMCM-3315's document defines it, with initialisation
// and field weakening.
#include "stator/control/stepper/closed_loop_controller.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include <gtest/gtest.h>

namespace stator::control {
namespace {

using namespace base::literals;

constexpr base::SimDuration kStep = 50_us;
constexpr double kSeconds = 50e-6;

/// A controller on an encoder with one count per 1/256 full step, initialised at set-point 0 and
/// count 0; the settings are those of the document's example.
class ClosedLoop : public testing::Test {
 protected:
  ClosedLoop() { initialise(); }

  static ClosedLoopSettings example() {
    ClosedLoopSettings settings;
    settings.enabled = true;
    settings.position_gain = 65'536;
    settings.tolerance = 255;
    settings.weakening_start = 300'000.0;
    settings.weakening_range = 1'600'000.0;
    settings.minimum_scale = 50;
    settings.upscale_delay = 1000;
    settings.downscale_delay = 10'000;
    settings.catch_up_gain = 3000;
    settings.catch_up_integral = 20;
    settings.error_sum_limit = 2000;
    settings.catch_up_velocity = 100'000.0;
    return settings;
  }
  void configure() { loop_.configure(settings_, scale_); }
  void initialise() {
    configure();
    loop_.start();
    for (int k = 0; k < 2100 && !loop_.active(); ++k) {
      step();
    }
    ASSERT_TRUE(loop_.active());
  }
  void initialise_anew() {
    loop_.stop();
    setpoint_ = count_;
    initialise();
  }
  ClosedLoopController::Commutation step() {
    return loop_.advance({.setpoint = setpoint_,
                          .velocity = velocity_,
                          .encoder_count = count_,
                          .may_initialise = may_initialise_,
                          .torque = torque_},
                         kStep);
  }
  /// A rotor that goes where the vector stands, with 200000 a second at most.
  void follow(int steps) {
    for (int k = 0; k < steps; ++k) {
      const std::int64_t vector = step().vector;
      count_ += std::clamp<std::int64_t>(vector - count_, -10, 10);
    }
  }
  void pass(base::SimDuration duration) {
    for (std::int64_t k = duration / kStep; k > 0; --k) {
      step();
    }
  }
  /// Turns the rotor with a velocity that is a multiple of 20000 a second, until it is measured.
  void turn(std::int64_t velocity) {
    velocity_ = static_cast<double>(velocity);
    for (int k = 0; k < 1000; ++k) {
      count_ += velocity / 20'000;
      setpoint_ = count_;
      step();
    }
  }

  ClosedLoopController loop_;
  ClosedLoopSettings settings_ = example();
  EncoderScale scale_{.counts_per_revolution = 51'200};
  std::int64_t setpoint_ = 0;
  double velocity_ = 0.0;
  std::int64_t count_ = 0;
  bool may_initialise_ = true;
  std::optional<double> torque_;
};

TEST_F(ClosedLoop, TheVectorStandsWhereTheRampSaysWhileTheLoadAngleIsWithinBeta) {
  for (setpoint_ = -255; setpoint_ <= 255; ++setpoint_) {
    EXPECT_EQ(step().vector, setpoint_);
  }
}

TEST_F(ClosedLoop, BeyondBetaTheVectorFollowsTheRotorInBothDirections) {
  settings_.catch_up_gain = 0;
  settings_.catch_up_integral = 0;
  for (const int direction : {1, -1}) {
    initialise_anew();
    for (int k = 1; k <= 2000; ++k) {
      count_ -= direction;  // 20000 a second, pushed back
      EXPECT_LE(std::llabs(step().vector - count_), 257) << k;
    }
    EXPECT_NEAR(loop_.load_angle(), direction * 255.0, 1e-9);
    EXPECT_NEAR(loop_.lag(), direction * (2000.0 - 255.0 + 24.0), 2.0) << "24: lead of damping";
  }
}

TEST_F(ClosedLoop, BetaLimitsTheAngleAsTheScaleOf256PerQuarterPeriodSays) {
  for (const int beta : {0, 128, 255, 383, 511}) {
    settings_.beta = beta;
    configure();
    setpoint_ = count_ + 5000;
    step();
    EXPECT_DOUBLE_EQ(loop_.load_angle(), beta);
    initialise_anew();
  }
}

TEST_F(ClosedLoop, DeviationsBeyondTheToleranceAreScaledByTheGain) {
  settings_.tolerance = 100;
  settings_.position_gain = 32'768;
  configure();
  setpoint_ = 80;
  step();
  EXPECT_DOUBLE_EQ(loop_.load_angle(), 80.0) << "gain 1 within the tolerance";
  setpoint_ = 200;
  step();
  EXPECT_DOUBLE_EQ(loop_.load_angle(), 100.0);
  setpoint_ = 500;
  step();
  EXPECT_DOUBLE_EQ(loop_.load_angle(), 250.0);
  EXPECT_EQ(loop_.lag(), 0.0);
  setpoint_ = 600;
  step();
  EXPECT_DOUBLE_EQ(loop_.load_angle(), 255.0);
  EXPECT_GT(loop_.lag(), 0.0);
}

TEST_F(ClosedLoop, FieldWeakeningAddsGammaByVelocityAsInTheExample) {
  turn(300'000);
  EXPECT_NEAR(loop_.angle_limit(), 255.0, 1e-6);
  turn(1'100'000);
  EXPECT_NEAR(loop_.angle_limit(), 382.5, 1e-6);
  turn(1'900'000);
  EXPECT_NEAR(loop_.angle_limit(), 510.0, 1e-6);
  turn(2'400'000);
  EXPECT_NEAR(loop_.angle_limit(), 510.0, 1e-6) << "at its maximum from 2034h + 2035h on";
  turn(-1'100'000);
  EXPECT_NEAR(loop_.angle_limit(), 382.5, 1e-6);
}

TEST_F(ClosedLoop, TheWeakenedAngleEndsAt180DegreeAndHelpsDrivingOnly) {
  settings_.beta = 400;
  configure();
  turn(2'000'000);
  EXPECT_DOUBLE_EQ(loop_.angle_limit(), 512.0);
  count_ += 100;
  setpoint_ = count_ + 20'000;
  step();
  EXPECT_DOUBLE_EQ(loop_.load_angle(), 512.0);
  initialise_anew();
  turn(2'000'000);
  count_ += 100;
  setpoint_ = count_ - 20'000;
  step();
  EXPECT_NEAR(loop_.load_angle(), -400.0, 1e-9) << "against the motion";
}

TEST_F(ClosedLoop, WithoutWeakeningVelocitiesGammaIsNotUsed) {
  settings_.weakening_start = 0.0;
  settings_.weakening_range = 0.0;
  configure();
  turn(1'900'000);
  EXPECT_DOUBLE_EQ(loop_.angle_limit(), 255.0);
}

TEST_F(ClosedLoop, CurrentScalesLinearlyWithTheLoadAngle) {
  settings_.upscale_delay = 0;
  settings_.downscale_delay = 0;
  configure();
  for (const int angle : {0, 51, 102, 153, 204, 255, -102, -255}) {
    setpoint_ = count_ + angle;
    const double current = step().current;
    const double expected = 50.0 + 205.0 * std::abs(angle) / 255.0;
    EXPECT_NEAR(loop_.current_scale(), std::floor(expected + 1e-9), 0.0) << angle;
    EXPECT_DOUBLE_EQ(current, loop_.current_scale() / 255.0);
  }
}

TEST_F(ClosedLoop, CurrentFollowsUpAndDownWithTheDelaysInClockCycles) {
  pass(500_ms);
  ASSERT_EQ(loop_.current_scale(), 50);
  setpoint_ = count_ + 255;
  pass(1_ms);  // 16000 cycles of 16 MHz, 1000 for a step
  EXPECT_EQ(loop_.current_scale(), 66);
  pass(12_ms);
  EXPECT_EQ(loop_.current_scale(), 255);
  setpoint_ = count_;
  pass(10_ms);  // 160000 cycles, 10000 for a step
  EXPECT_EQ(loop_.current_scale(), 239);
}

TEST_F(ClosedLoop, CatchUpVelocityIsLimited) {
  setpoint_ = 20'000;
  settings_.catch_up_gain = 16'777'215;
  configure();
  follow(400);
  double lag = loop_.lag();
  ASSERT_GT(lag, 5000.0);
  const std::int64_t before = count_;
  for (int k = 0; k < 100; ++k) {
    follow(1);
    EXPECT_NEAR(lag - loop_.lag(), 100'000.0 * kSeconds, 1e-6);
    lag = loop_.lag();
  }
  EXPECT_NEAR(static_cast<double>(count_ - before), 500.0, 20.0) << "the rotor with it";
}

TEST_F(ClosedLoop, CatchUpFollowsTheRegulatorOfTheDocument) {
  setpoint_ = 5000;
  settings_.catch_up_integral = 0;
  configure();
  follow(200);
  const double lag = loop_.lag();
  ASSERT_GT(lag, 2000.0);
  follow(1000);
  // P = 3000 / 256 per second alone: an exponential with a time constant of 85.3 ms.
  EXPECT_NEAR(loop_.lag() / lag, std::exp(-0.05 * 3000.0 / 256.0), 1e-3);

  settings_.catch_up_gain = 0;
  settings_.catch_up_integral = 20;
  settings_.error_sum_limit = 10;
  configure();
  const double before = loop_.lag();
  follow(1000);
  // The sum is at its limit of 10 * 65536 within a few steps: 20 / 65536 of it, 200 a second.
  EXPECT_NEAR(before - loop_.lag(), 200.0 * 0.05, 0.1);
}

TEST_F(ClosedLoop, CatchUpEndsOnTheRampAndNotBeyond) {
  setpoint_ = 3000;
  for (int k = 0; k < 20'000; ++k) {
    follow(1);
    EXPECT_GE(loop_.lag(), 0.0);
    EXPECT_LE(count_, 3001);
  }
  EXPECT_EQ(loop_.lag(), 0.0);
  EXPECT_EQ(step().vector, 3000);
}

TEST_F(ClosedLoop, WithoutRegulatorGainsALagStays) {
  setpoint_ = 3000;
  settings_.catch_up_gain = 0;
  settings_.catch_up_integral = 0;
  configure();
  follow(2000);
  const double lag = loop_.lag();
  EXPECT_GT(lag, 2000.0);
  follow(2000);
  EXPECT_EQ(loop_.lag(), lag);
}

TEST_F(ClosedLoop, InitialisationWaitsForAnEncoderThatIsStill) {
  loop_.stop();
  loop_.start();
  for (int k = 0; k < 4000; ++k) {
    count_ = k % 40 < 20 ? 0 : 5;  // a swinging rotor
    setpoint_ = 700;
    const auto commutation = step();
    EXPECT_EQ(commutation.vector, 700);
    EXPECT_EQ(commutation.current, 1.0) << "the run current";
    EXPECT_FALSE(loop_.active());
  }
  may_initialise_ = false;
  pass(200_ms);
  EXPECT_FALSE(loop_.active()) << "the ramp moves or the brake holds";
  may_initialise_ = true;
  pass(90_ms);
  EXPECT_FALSE(loop_.active());
  pass(11_ms);
  EXPECT_TRUE(loop_.active());
}

TEST_F(ClosedLoop, TheOffsetIsMeasuredWhereverTheEncoderStands) {
  for (const bool reversed : {false, true}) {
    for (const std::int64_t count : {0, 12'345, -7, 987'654'321, -987'654'321}) {
      loop_.stop();
      scale_ = {.counts_per_revolution = 40'000, .reversed = reversed};
      count_ = count;
      setpoint_ = 333;
      initialise();
      const double turned = static_cast<double>(count) * (reversed ? -1.28 : 1.28);
      EXPECT_NEAR(loop_.commutation_offset(),
                  static_cast<double>(static_cast<std::int32_t>(std::llround(333.0 - turned))),
                  1.0);
      setpoint_ = 433;
      count_ += reversed ? -50 : 50;  // 64 steps forward
      step();
      EXPECT_NEAR(loop_.deviation(), 36.0, 10.0) << "the rest is the velocity's";
    }
  }
}

TEST_F(ClosedLoop, AWrittenOffsetTurnsTheCommutation) {
  setpoint_ = 100;
  step();
  ASSERT_DOUBLE_EQ(loop_.load_angle(), 100.0);
  loop_.set_commutation_offset(loop_.commutation_offset() + 30);
  step();
  EXPECT_DOUBLE_EQ(loop_.load_angle(), 70.0);
}

TEST_F(ClosedLoop, AnotherEncoderEndsClosedLoop) {
  scale_.counts_per_revolution = 40'000;
  configure();
  EXPECT_EQ(loop_.phase(), ClosedLoopController::Phase::off);
}

TEST_F(ClosedLoop, TorqueStandsAtTheAngleLimitWithItsShareOfTheCurrent) {
  torque_ = 0.25;
  setpoint_ = 4000;
  auto commutation = step();
  EXPECT_EQ(commutation.vector, count_ + 255);
  EXPECT_DOUBLE_EQ(commutation.current, 0.25);
  EXPECT_EQ(loop_.current_scale(), 63);
  torque_ = -3.0;
  commutation = step();
  EXPECT_EQ(commutation.vector, count_ - 255);
  EXPECT_DOUBLE_EQ(commutation.current, 1.0) << "not more than the run current";
  torque_ = 0.0;
  EXPECT_EQ(step().current, 0.0);
}

TEST(RotorObserver, DoesNotDriftOverAnyNumberOfRevolutions) {
  RotorObserver rotor;
  rotor.set_scale({.counts_per_revolution = 4000});
  rotor.place(10, 0);
  std::int64_t count = 0;
  for (int k = 0; k < 1'000'000; ++k) {
    count += 1999;
    rotor.advance(count, kStep);
  }
  EXPECT_DOUBLE_EQ(static_cast<double>(rotor.base()) + rotor.within(), 10.0 + 12.8 * 1999e6);
  EXPECT_NEAR(rotor.velocity(), 1999 * 12.8 / kSeconds, 1e-3);
  for (int k = 0; k < 2'000'000; ++k) {
    count -= 1999;
    rotor.advance(count, kStep);
  }
  EXPECT_DOUBLE_EQ(static_cast<double>(rotor.base()) + rotor.within(), 10.0 - 12.8 * 1999e6);
  EXPECT_EQ(rotor.position_of_count_zero(), 10);
}

TEST(RotorObserver, StandsStillWhenNoCountComesFor20Milliseconds) {
  RotorObserver rotor;
  rotor.set_scale({.counts_per_revolution = 51'200});
  rotor.place(0, 0);
  rotor.advance(1, kStep);
  for (int k = 0; k < 398; ++k) {
    rotor.advance(1, kStep);
  }
  EXPECT_NE(rotor.velocity(), 0.0);
  rotor.advance(1, kStep);
  rotor.advance(1, kStep);
  EXPECT_EQ(rotor.velocity(), 0.0);
}

}  // namespace
}  // namespace stator::control
