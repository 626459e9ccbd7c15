// The TMCM-142's motion controller as a whole: flags, switches, latches, currents, encoder, PID.
#include "stator/control/motion_controller/motion_controller.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"

namespace stator::control::motion_controller {
namespace {

using namespace base::literals;

constexpr base::SimDuration kPeriod = 100_us;

/// A controller with both switch pins inactive (high) and an encoder of one count per microstep
/// that sits on the motor, `lost` microsteps behind.
class Bench {
 public:
  Bench() { sensing.left_switch = sensing.right_switch = true; }

  void run(base::SimDuration duration) {
    for (base::SimDuration t; t < duration; t += kPeriod) {
      sensing.encoder_count = controller.motor_microsteps() - lost;
      controller.advance(sensing, kPeriod);
    }
  }
  template <typename Change>
  void configure(const Change& change) {
    Settings settings = controller.settings();
    change(settings);
    controller.configure(settings);
  }

  MotionController controller;
  base::AxisSensing sensing;
  std::int64_t lost = 0;
};

TEST(MotionController, MovesToATargetAndTellsSoInItsFlags) {
  Bench bench;
  EXPECT_EQ(bench.controller.status_flags(), 0x7U);
  bench.controller.move_to(1'000);
  bench.run(20_ms);
  EXPECT_EQ(bench.controller.velocity(), 500'000);
  EXPECT_EQ(bench.controller.status_flags(), 0U);
  bench.run(200_ms);
  EXPECT_EQ(bench.controller.position(), 1'000);
  EXPECT_TRUE(bench.controller.position_reached());
  EXPECT_EQ(bench.controller.status_flags(), 0x7U) << "AP 2 is 0 and so is AP 3";
  EXPECT_EQ(bench.controller.motor_microsteps(), 1'000);
  EXPECT_EQ(bench.controller.table_position(), 2'000) << "two entries per microstep of 1024";
}

TEST(MotionController, RotatesAndStopsWithItsRamps) {
  Bench bench;
  bench.controller.rotate(-350'000);
  bench.run(1_s);
  EXPECT_EQ(bench.controller.velocity(), -350'000);
  EXPECT_TRUE(bench.controller.velocity_reached());
  EXPECT_EQ(bench.controller.mode(), Mode::velocity);
  bench.controller.rotate(0);
  bench.run(kPeriod);
  EXPECT_EQ(bench.controller.velocity(), -350'000 + 50'000 * 1'600 / 4'096) << "1600 clocks";
  bench.run(1_s);
  EXPECT_EQ(bench.controller.status_flags() & 0x6U, 0x6U);
}

TEST(MotionController, TheShaftBitTurnsTheMotorNotThePosition) {
  Bench bench;
  bench.configure([](Settings& settings) { settings.shaft = true; });
  bench.controller.move_to(500);
  bench.run(1_s);
  EXPECT_EQ(bench.controller.position(), 500);
  EXPECT_EQ(bench.controller.table_position(), 8'192 - 1'000);
  EXPECT_FALSE(bench.controller.step_direction().forward);
}

TEST(MotionController, ResolutionLeavesPositionsAndTakesTheSineOffset) {
  Bench bench;
  bench.controller.move_to(100);
  bench.run(1_s);
  bench.configure([](Settings& settings) { settings.sine_offset = 64; });
  const double before = bench.controller.table().wave(1);
  EXPECT_LT(before, 0.001) << "not yet";
  bench.controller.set_microstep_resolution(3);
  EXPECT_GT(bench.controller.table().wave(1), 0.06);
  EXPECT_EQ(bench.controller.position(), 100);
  EXPECT_EQ(bench.controller.table_position(), 200);
  bench.controller.move_to(101);
  bench.run(1_s);
  EXPECT_EQ(bench.controller.table_position(), 208);
}

TEST(MotionController, StandbyCurrentComesAfterItsDelay) {
  Bench bench;
  bench.configure([](Settings& settings) {
    settings.current = {.run = 12, .standby = 3, .standby_delay = 10};  // 40.96 ms
  });
  bench.controller.move_to(100);
  bench.run(1_ms);
  EXPECT_FALSE(bench.controller.standing());
  while (!bench.controller.standing()) {
    EXPECT_EQ(bench.controller.current_scale(), 12);
    bench.run(kPeriod);
  }
  bench.run(40'800_us);  // 40.9 ms with the period it came to rest in
  EXPECT_EQ(bench.controller.current_scale(), 12);
  bench.run(200_us);
  EXPECT_EQ(bench.controller.current_scale(), 3);
  bench.controller.move_to(0);
  bench.run(kPeriod);
  EXPECT_EQ(bench.controller.current_scale(), 12);
}

TEST(MotionController, StepPulsesCountAndMergeWhenTooLong) {
  Bench bench;
  bench.configure([](Settings& settings) {
    settings.step_pulse_length = 255;
    settings.ramp.maximum_velocity = 10'000'000;
  });
  EXPECT_EQ(bench.controller.step_direction().pulse_length, 15'937'500) << "ps";
  bench.controller.move_to(100'000);
  bench.run(50_ms);  // 149 kpps: every 6.7 us
  EXPECT_TRUE(bench.controller.step_direction().merged);
  bench.configure([](Settings& settings) { settings.step_pulse_length = 16; });
  bench.run(kPeriod);
  EXPECT_FALSE(bench.controller.step_direction().merged);
  bench.run(2_s);
  EXPECT_EQ(bench.controller.step_direction().pulses, 100'000);
  EXPECT_TRUE(bench.controller.step_direction().forward);
  EXPECT_EQ(bench.controller.full_step_pulses(), 100'000 / 1'024);
  bench.controller.move_to(99'000);
  bench.run(2_s);
  EXPECT_EQ(bench.controller.step_direction().pulses, 101'000);
  EXPECT_FALSE(bench.controller.step_direction().forward);
}

TEST(MotionController, SwitchesStopAndLatch) {
  Bench bench;
  bench.configure([](Settings& settings) {
    settings.switches.mode = switch_mode::kLatchRightActive | switch_mode::kLatchEncoder;
  });
  bench.lost = 5;
  bench.controller.rotate(500'000);
  bench.run(100_ms);
  const std::int32_t position = bench.controller.position();
  bench.sensing.right_switch = false;
  bench.run(kPeriod);
  EXPECT_EQ(bench.controller.velocity(), 0);
  EXPECT_EQ(bench.controller.latched_position(), position);
  EXPECT_EQ(bench.controller.encoder_latch(), bench.controller.encoder_position());
  EXPECT_EQ(bench.controller.read_switch_status(), 0x2AU);
  EXPECT_EQ(bench.controller.read_switch_status(), 0x22U);
  bench.controller.rotate(-500'000);
  bench.run(100_ms);
  EXPECT_EQ(bench.controller.velocity(), -500'000);
}

TEST(MotionController, ADisabledSwitchDoesNotStop) {
  Bench bench;
  bench.configure([](Settings& settings) { settings.switches.right_disabled = true; });
  bench.controller.rotate(500'000);
  bench.sensing.right_switch = false;
  bench.run(100_ms);
  EXPECT_EQ(bench.controller.velocity(), 500'000);
  EXPECT_TRUE(bench.controller.right_switch());
}

TEST(MotionController, WarnsBeyondItsDistanceOnly) {
  Bench bench;
  bench.configure([](Settings& settings) { settings.encoder.warn_distance = 20; });
  bench.run(kPeriod);
  bench.lost = 20;
  bench.run(kPeriod);
  EXPECT_EQ(bench.controller.encoder_position(), -20);
  EXPECT_EQ(bench.controller.status_flags() & 8U, 0U);
  bench.lost = 21;
  bench.run(kPeriod);
  EXPECT_EQ(bench.controller.status_flags() & 8U, 8U);
  bench.lost = 0;
  bench.run(kPeriod);
  EXPECT_EQ(bench.controller.status_flags() & 8U, 0U);
}

TEST(MotionController, TooLargeADeviationStopsTheMotorUntilTheNextCommand) {
  Bench bench;
  bench.configure([](Settings& settings) { settings.encoder.maximum_deviation = 50; });
  bench.run(kPeriod);
  bench.lost = 51;
  bench.run(10_ms);
  EXPECT_EQ(bench.controller.error_flags(), 0U) << "there is nothing to stop";
  bench.controller.move_to(100'000);
  bench.run(10_ms);
  EXPECT_TRUE(bench.controller.stopped_by_deviation());
  EXPECT_EQ(bench.controller.velocity(), 0);
  EXPECT_EQ(bench.controller.read_error_flags(), 2U);
  EXPECT_EQ(bench.controller.read_error_flags(), 0U);
  bench.run(100_ms);
  EXPECT_EQ(bench.controller.error_flags(), 0U);
  EXPECT_LT(bench.controller.position(), 10);
  bench.lost = 50;
  bench.controller.move_to(1'000);
  bench.run(1_s);
  EXPECT_EQ(bench.controller.position(), 1'000) << "50 is not more than 50";
  EXPECT_EQ(bench.controller.error_flags(), 0U);
}

TEST(MotionController, TheRegulatorBringsTheEncoderToThePosition) {
  Bench bench;
  bench.configure([](Settings& settings) {
    settings.regulator = {.tolerance = 2,
                          .p = 1'000'000,
                          .i = 1'000,
                          .integral_clip = 1'000,
                          .velocity_clip = 1'000'000,
                          .enabled = true};
  });
  bench.run(10_ms);
  bench.lost = 37;
  bench.run(2_s);
  EXPECT_EQ(bench.controller.position(), 0);
  EXPECT_NEAR(bench.controller.encoder_position(), 0, 1);
  EXPECT_NEAR(static_cast<double>(bench.controller.motor_microsteps()), 37.0, 1.0);
  EXPECT_EQ(bench.controller.regulator_sum(), 0);
  bench.controller.move_to(-10'000);
  bench.lost = 500;
  bench.run(5_s);
  EXPECT_EQ(bench.controller.position(), -10'000);
  EXPECT_NEAR(bench.controller.encoder_position(), -10'000, 2);
}

TEST(MotionController, TheRegulatorRestsAfterAStopByDeviation) {
  Bench bench;
  bench.configure([](Settings& settings) {
    settings.regulator = {.p = 1'000'000, .velocity_clip = 1'000'000, .enabled = true};
    settings.encoder.maximum_deviation = 50;
  });
  bench.run(kPeriod);
  bench.lost = 51;
  bench.controller.move_to(10);
  bench.run(kPeriod);
  ASSERT_TRUE(bench.controller.stopped_by_deviation());
  const std::int64_t microsteps = bench.controller.motor_microsteps();
  bench.run(100_ms);
  EXPECT_EQ(bench.controller.motor_microsteps(), microsteps);
  EXPECT_EQ(bench.controller.pid_velocity(), 0);
  EXPECT_LT(bench.controller.regulator_error(), -50) << "still told";
  bench.lost = 40;
  bench.controller.move_to(0);
  bench.run(1_s);
  EXPECT_NEAR(bench.controller.encoder_position(), 0, 1);
}

TEST(MotionController, PidVelocityIsRampAndRegulatorTogether) {
  Bench bench;
  bench.configure([](Settings& settings) {
    settings.regulator = {.p = 25'600, .velocity_clip = 40'000, .enabled = true};
  });
  bench.run(kPeriod);
  bench.controller.rotate(100'000);
  bench.run(100_ms);
  bench.lost += 10'000;
  bench.run(kPeriod);
  EXPECT_EQ(bench.controller.velocity(), 100'000);
  EXPECT_EQ(bench.controller.pid_velocity(), 140'000);
  EXPECT_LT(bench.controller.regulator_error(), -9'000);
}

TEST(MotionController, AWrittenPositionIsReadBackAndTheMotorGoesToItsTarget) {
  Bench bench;
  bench.controller.set_position(70'000);
  EXPECT_EQ(bench.controller.position(), 70'000);
  EXPECT_EQ(bench.controller.motor_microsteps(), 0);
  EXPECT_FALSE(bench.controller.position_reached());
  bench.run(20_s);
  EXPECT_EQ(bench.controller.position(), 0);
  EXPECT_EQ(bench.controller.motor_microsteps(), -70'000);
}

TEST(MotionController, EncoderModeReadsBackWithoutTheBitThatActed) {
  Bench bench;
  const std::uint32_t mode = encoder_mode::kNullActiveHigh | encoder_mode::kIgnoreAb |
                             encoder_mode::kPositiveEdge | encoder_mode::kClearOnNull;
  bench.run(kPeriod);
  bench.controller.set_encoder_mode(mode | encoder_mode::kClearOnce);
  bench.sensing.encoder_index_passages = 1;
  bench.sensing.encoder_index = true;
  bench.run(kPeriod);
  EXPECT_EQ(bench.controller.settings().encoder.mode, mode);
  EXPECT_TRUE(bench.controller.read_encoder_status());
  EXPECT_FALSE(bench.controller.encoder_status());
}

/// Hash of everything a device sees, over random commands.
std::uint64_t trace(std::uint64_t seed) {
  base::Random random(seed);
  Bench bench;
  std::uint64_t hash = 14'695'981'039'346'656'037ULL;
  const auto note = [&](std::int64_t value) {
    hash = (hash ^ static_cast<std::uint64_t>(value)) * 1'099'511'628'211ULL;
  };
  for (int command = 0; command < 2'000; ++command) {
    bench.configure([&](Settings& settings) {
      settings.ramp = {.maximum_velocity = static_cast<std::uint32_t>(random.below(100'000'000)),
                       .acceleration = static_cast<std::uint32_t>(1 + random.below(100'000)),
                       .deceleration = static_cast<std::uint32_t>(1 + random.below(100'000)),
                       .bow = static_cast<std::uint8_t>(random.below(19))};
      settings.regulator = {.p = 10'000, .velocity_clip = 100'000, .enabled = command % 2 == 0};
    });
    bench.lost = static_cast<std::int64_t>(random.below(50));
    if (random.below(2) == 0) {
      bench.controller.move_to(static_cast<std::int32_t>(random.below(200'000)));
    } else {
      bench.controller.rotate(static_cast<std::int32_t>(random.below(20'000'000)) - 10'000'000);
    }
    for (std::uint64_t k = random.below(100); k > 0; --k) {
      bench.run(kPeriod);
      note(bench.controller.position());
      note(bench.controller.pid_velocity());
      note(bench.controller.motor_microsteps());
    }
  }
  return hash;
}

TEST(MotionController, HasTheSameBitsEverywhere) {
  EXPECT_EQ(trace(1), 5'668'727'427'730'072'939ULL);
}

}  // namespace
}  // namespace stator::control::motion_controller
