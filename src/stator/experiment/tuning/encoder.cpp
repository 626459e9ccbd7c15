#include "stator/experiment/tuning/encoder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include <fmt/format.h>

#include "stator/experiment/tuning/statistics.hpp"
#include "stator/experiment/tuning/tuning_error.hpp"
#include "stator/experiment/tuning/winding.hpp"

namespace stator::experiment::tuning {
namespace {

using control::foc::field;

constexpr double kTurn = 65536.0;                 // OPENLOOP_PHI of an electrical revolution
constexpr std::int32_t kFieldSpeed = 300;         // electrical rpm
constexpr std::int32_t kFieldAcceleration = 600;  // electrical rpm/s
constexpr int kMostPolePairs = 64;
constexpr std::int32_t kBridgeOff = 0;  // PWM_CHOP
constexpr std::int32_t kLowSidesOn = 1;
constexpr std::int32_t kCentredPwm = 7;

/// The field of the open-loop generator, followed over whole revolutions.
class Field {
 public:
  explicit Field(Chip& chip) : chip_(chip), shown_(chip.get(field("OPENLOOP_PHI"))) {}

  void step() {
    chip_.step();
    const std::int32_t shown = chip_.get(field("OPENLOOP_PHI"));
    angle_ += static_cast<std::int16_t>(static_cast<std::uint16_t>(shown - shown_));
    shown_ = shown;
  }
  /// 65536 per electrical revolution, since the tool took hold of the field.
  [[nodiscard]] std::int64_t angle() const { return angle_; }

  void set_speed(std::int32_t rpm) {
    chip_.set(field("OPENLOOP_VELOCITY_TARGET"), rpm);
    while (chip_.get(field("OPENLOOP_VELOCITY_ACTUAL")) != rpm) {
      step();
    }
  }
  /// `turns` electrical revolutions at the present speed.
  void turn(double turns) {
    const std::int64_t from = angle_;
    while (static_cast<double>(std::llabs(angle_ - from)) < turns * kTurn) {
      step();
    }
  }

 private:
  Chip& chip_;
  std::int32_t shown_;
  std::int64_t angle_ = 0;
};

/// Means over whole electrical revolutions at constant speed.
struct Sweep {
  double field = 0.0;            ///< 65536 per electrical revolution
  double count = 0.0;            ///< of the encoder
  double counts_per_turn = 0.0;  ///< electrical
};

Sweep sweep(Chip& chip, Field& moving, int turns) {
  const std::int64_t field_before = moving.angle();
  const std::int64_t count_before = chip.count();
  Mean field_mean;
  Mean count_mean;
  while (static_cast<double>(std::llabs(moving.angle() - field_before)) < turns * kTurn) {
    moving.step();
    field_mean.add(static_cast<double>(moving.angle()));
    count_mean.add(static_cast<double>(chip.count()));
  }
  const double turned = static_cast<double>(moving.angle() - field_before) / kTurn;
  return {.field = field_mean.value(),
          .count = count_mean.value(),
          .counts_per_turn = static_cast<double>(chip.count() - count_before) / turned};
}

/// With the bridge off the current of the winding dies in the diodes and the shaft goes on; when
/// all low sides then short the winding, a shaft that turns drives a current again.
bool drives_current(Chip& chip) {
  constexpr double kDying = 5e-3;  // s
  chip.set_voltage(0);
  chip.set(field("PWM_CHOP"), kBridgeOff);
  chip.run(kDying);
  chip.set(field("PWM_CHOP"), kLowSidesOn);
  Mean square;
  for (int left = chip.periods(2e-3); left > 0; --left) {
    chip.step();
    const Sample sample = chip.sample();
    square.add(sample.id * sample.id + sample.iq * sample.iq);
  }
  chip.set(field("PWM_CHOP"), kCentredPwm);
  return std::sqrt(square.value()) > 0.03 * chip.settings().current;
}

/// The field turned and the encoder did not count: finds out why.
[[noreturn]] void explain_silence(Chip& chip, Field& moving) {
  for (std::int32_t speed = 2 * kFieldSpeed; speed <= 16 * kFieldSpeed; speed *= 2) {
    chip.set(field("OPENLOOP_ACCELERATION"), std::int64_t{8} * kFieldAcceleration);
    moving.set_speed(speed);
    moving.turn(4.0);
    const std::int32_t voltage = chip.get(field("UD_EXT"));
    if (drives_current(chip)) {
      throw TuningError(
          Obstacle::encoder_silent,
          "encoder: the motor turns, as the current it drives when shorted shows, but "
          "the encoder does not count; look at its supply and at A and B");
    }
    chip.set_voltage(voltage);
  }
  throw TuningError(Obstacle::shaft_blocked,
                    "encoder: neither does the encoder count nor does the shaft turn; release the "
                    "brake, free the shaft, or raise --current");
}

[[noreturn]] void fail_to_follow() {
  throw TuningError(Obstacle::shaft_blocked,
                    "encoder: the shaft did not follow the field all the way; move it off its end "
                    "stop, free it, or raise --current");
}

struct Index {
  std::optional<double> distance;  ///< counts from one N pulse to the next
  std::int64_t latest = 0;
};

/// Goes forward until two N pulses have been met, or two revolutions of any motor.
Index find_index(Chip& chip, Field& moving, double counts_per_turn) {
  Index index;
  std::optional<std::int64_t> first;
  static_cast<void>(chip.take_index());  // those met before
  auto before = static_cast<double>(chip.count());
  for (int turns = 0; turns < 2 * kMostPolePairs; ++turns) {
    moving.turn(1.0);
    const auto now = static_cast<double>(chip.count());
    if ((now - before) / counts_per_turn < 0.5) {
      fail_to_follow();
    }
    before = now;
    if (!chip.take_index()) {
      continue;
    }
    index.latest = chip.index_count();
    if (first) {
      index.distance = std::fabs(static_cast<double>(index.latest - *first));
      return index;
    }
    first = index.latest;
  }
  return index;
}

[[noreturn]] void fail_resolution(const std::string& text) {
  throw TuningError(Obstacle::encoder_resolution, "encoder: " + text);
}

/// Counts per revolution: from N pulse to N pulse, as claimed, or by the pole pairs claimed.
std::int32_t resolution_of(const Settings& settings, const Index& index, double counts_per_turn) {
  const auto claimed = settings.encoder_resolution;
  if (index.distance) {
    const double distance = *index.distance;
    if (claimed && std::fabs(distance - *claimed) > 2.0 + 0.001 * distance) {
      fail_resolution(
          fmt::format("{:.0f} counts lie between two N pulses, {} were claimed; correct "
                      "--encoder-resolution (four per line)",
                      distance, *claimed));
    }
    return claimed ? *claimed : static_cast<std::int32_t>(std::lround(distance));
  }
  if (claimed) {
    return *claimed;
  }
  if (settings.pole_pairs) {
    return static_cast<std::int32_t>(std::lround(counts_per_turn * *settings.pole_pairs));
  }
  fail_resolution(
      "there is no N pulse, so only counts per electrical turn can be measured; state "
      "--encoder-resolution or --pole-pairs");
}

std::int32_t pole_pairs_of(const Settings& settings, std::int32_t resolution,
                           double counts_per_turn, bool by_index) {
  constexpr double kTolerance = 0.05;
  const double ratio = resolution / counts_per_turn;
  const double whole = std::round(ratio);
  if (settings.pole_pairs && std::fabs(ratio - *settings.pole_pairs) > kTolerance) {
    if (!by_index && settings.encoder_resolution) {
      throw TuningError(
          Obstacle::pole_pairs,
          fmt::format("encoder: {} counts per revolution and {} pole pairs make {:.1f} counts per "
                      "electrical turn, {:.1f} were measured; one of the two is wrong",
                      resolution, *settings.pole_pairs, 1.0 * resolution / *settings.pole_pairs,
                      counts_per_turn));
    }
    throw TuningError(
        Obstacle::pole_pairs,
        fmt::format("encoder: the shaft makes a revolution in {:.2f} electrical turns; "
                    "{} pole pairs were claimed, correct --pole-pairs",
                    ratio, *settings.pole_pairs));
  }
  if (whole < 1.0 || std::fabs(ratio - whole) > kTolerance) {
    fail_resolution(
        fmt::format("{} counts per revolution make {:.2f} pole pairs, which is no whole number; "
                    "correct --encoder-resolution, or look for counts that get lost",
                    resolution, ratio));
  }
  return static_cast<std::int32_t>(whole);
}

/// phi_e of the rotor at count 0, of one sweep, with forward counts.
double angle_at_zero(const Sweep& sweep, double counts_per_turn) {
  return sweep.field - kTurn * sweep.count / counts_per_turn;
}

/// Within half a turn of 0.
double wrapped(double angle) {
  return angle - kTurn * std::round(angle / kTurn);
}

void check_direction(const Chip& chip, bool reversed) {
  const auto claimed = chip.settings().encoder_reversed;
  if (claimed && *claimed != reversed) {
    throw TuningError(Obstacle::encoder_reversed,
                      fmt::format("encoder: it counts {} while the field turns forward; exchange A "
                                  "and B, or two phases of the motor, or claim the other direction",
                                  reversed ? "down" : "up"));
  }
}

/// The rotor's place in the middle between both ways, and what the halves of the ways say.
Measured align(Chip& chip, Field& moving, const Encoder& encoder) {
  const int turns = encoder.pole_pairs;
  const double counts = static_cast<double>(encoder.resolution) / encoder.pole_pairs;
  const auto both_ways = [&] {
    moving.set_speed(kFieldSpeed);
    moving.turn(1.0);
    const double forward = angle_at_zero(sweep(chip, moving, turns), counts);
    moving.set_speed(-kFieldSpeed);
    moving.turn(1.0);
    const double back = angle_at_zero(sweep(chip, moving, turns), counts);
    return 0.5 * (forward + back);
  };
  const double first = both_ways();
  const double second = both_ways();
  const double middle = 0.5 * (first + second);
  // The counter's steps are known to a twelfth of their square.
  const double step = kTurn / counts / std::sqrt(12.0 * turns);
  return {wrapped(middle), std::hypot(0.5 * (first - second), step)};
}

}  // namespace

Encoder measure_encoder(Chip& chip) {
  const std::int32_t voltage = raise_current(chip, 0, chip.settings().current);
  wait_for_rest(chip, 1.0);
  // The field goes on from where it holds the rotor.
  chip.set(field("OPENLOOP_PHI"), 0);
  chip.set(field("OPENLOOP_VELOCITY_ACTUAL"), 0);
  chip.set(field("OPENLOOP_ACCELERATION"), kFieldAcceleration);
  chip.turn_field();
  chip.set_voltage(voltage);
  Field moving(chip);
  moving.set_speed(kFieldSpeed);
  const std::int64_t before = chip.count();
  moving.turn(1.0);
  const auto first = static_cast<double>(chip.count() - before);
  if (std::fabs(first) < 2.0) {
    explain_silence(chip, moving);
  }
  constexpr int kTurns = 2;
  constexpr double kUneven = 0.3;
  const double rough = sweep(chip, moving, kTurns).counts_per_turn;
  if (std::fabs(rough / first - 1.0) > kUneven) {
    fail_to_follow();
  }
  const Index index = find_index(chip, moving, rough);
  Encoder encoder;
  encoder.reversed = rough < 0.0;
  check_direction(chip, encoder.reversed);
  encoder.has_index = index.distance.has_value();
  encoder.resolution = resolution_of(chip.settings(), index, std::fabs(rough));
  const double turns = std::fabs(sweep(chip, moving, 4 * kTurns).counts_per_turn);
  encoder.pole_pairs = pole_pairs_of(chip.settings(), encoder.resolution, turns, encoder.has_index);
  chip.set_encoder(encoder.resolution, encoder.reversed);
  chip.set(field("N_POLE_PAIRS"), encoder.pole_pairs);
  encoder.offset = align(chip, moving, encoder);
  moving.set_speed(0);
  chip.set(field("ABN_DECODER_PHI_E_OFFSET"), std::lround(encoder.offset.value));
  if (encoder.has_index) {
    const double counts = static_cast<double>(encoder.resolution) / encoder.pole_pairs;
    encoder.index_offset =
        wrapped(encoder.offset.value + kTurn * static_cast<double>(chip.index_count()) / counts);
  }
  return encoder;
}

}  // namespace stator::experiment::tuning
