#include "stator/control/servo/encoder_commutation.hpp"

#include <cstdlib>

#include "stator/control/rounding.hpp"

namespace stator::control {

namespace {

constexpr double kPeriodsPerMinute = 1'200'000.0;
constexpr std::int64_t kSearchedRevolutions = 3;

constexpr std::int64_t modulo(std::int64_t value, std::int64_t divisor) {
  const std::int64_t remainder = value % divisor;
  return remainder < 0 ? remainder + divisor : remainder;
}

/// Electrical turns per count, 2^64 = 1 turn; long division, whole turns drop out.
constexpr std::uint64_t turns_per_count(std::uint64_t pole_pairs, std::uint64_t steps) {
  const std::uint64_t high = (pole_pairs % steps) << 32;
  const std::uint64_t low = (high % steps) << 32;
  return ((high / steps) << 32) + (low + steps / 2) / steps;
}

}  // namespace

void EncoderCommutation::configure(const ServoControllerSettings& settings) {
  mode_ = settings.init_mode;
  delay_ = settings.init_delay;
  velocity_ = settings.init_velocity;
  const std::int64_t steps = settings.encoder_steps == 0 ? 1 : settings.encoder_steps;
  if (steps != steps_ || settings.pole_pairs != pole_pairs_ ||
      settings.encoder_reversed != reversed_) {
    steps_ = steps;
    pole_pairs_ = settings.pole_pairs;
    scale_ =
        turns_per_count(static_cast<std::uint64_t>(pole_pairs_), static_cast<std::uint64_t>(steps));
    if (settings.encoder_reversed != reversed_) {
      reversed_ = settings.encoder_reversed;
      count_ = -count_;
      reference_ = -reference_;
    }
    forget();
    configured_offset_ = settings.encoder_offset;
    set_offset(configured_offset_);
  } else if (settings.encoder_offset != configured_offset_) {
    configured_offset_ = settings.encoder_offset;
    awaits_edge_ = false;
    set_offset(configured_offset_);
  }
}

EncoderCommutation::Field EncoderCommutation::start(const Observation& seen) {
  elapsed_ = 0;
  awaits_edge_ = false;
  field_ = {};
  switch (mode_) {
    case EncoderInitMode::hall:
      phase_ = seen.hall_valid ? Phase::known : Phase::failed;
      if (seen.hall_valid) {
        place(seen.hall_angle);
        awaits_edge_ = true;
      }
      break;
    case EncoderInitMode::align: {
      phase_ = Phase::aligning;
      const std::uint32_t sweep_periods = delay_ * 5;  // 20 per millisecond, a quarter of them
      constexpr std::uint32_t kQuarterTurn = 0x4000'0000;
      field_.step = {sweep_periods == 0 ? 0 : kQuarterTurn / sweep_periods};
      field_.angle = {0U - kQuarterTurn};
      break;
    }
    case EncoderInitMode::index:
      phase_ = velocity_ == 0 ? Phase::failed : Phase::seeking_index;
      passages_ = seen.index_passages;
      field_.step =
          angle_of_turns(static_cast<double>(velocity_) * pole_pairs_ / kPeriodsPerMinute);
      break;
  }
  return field_;
}

bool EncoderCommutation::pass_millisecond(const Observation& seen) {
  ++elapsed_;
  if (phase_ == Phase::aligning) {
    if (elapsed_ >= delay_) {
      phase_ = seen.current_flows ? Phase::known : Phase::failed;
      if (seen.current_flows) {
        place(ElectricalAngle{});
      }
    } else if (elapsed_ == (delay_ + 3) / 4) {
      field_ = {};
      return true;
    }
  } else if (phase_ == Phase::seeking_index) {
    if (seen.index_passages != passages_) {
      phase_ = Phase::known;
      reference_ = reversed_ ? -seen.index_count : seen.index_count;
      set_offset(configured_offset_);
    } else if (std::int64_t{elapsed_} * std::abs(std::int64_t{velocity_}) >
               kSearchedRevolutions * 60'000) {
      phase_ = Phase::failed;
    }
  }
  return false;
}

void EncoderCommutation::place(ElectricalAngle angle) {
  const double ahead =
      static_cast<double>(angle.value) * static_cast<double>(steps_) / (4294967296.0 * pole_pairs_);
  reference_ = 0;
  set_offset(nearest_integer(ahead) - count_);
}

void EncoderCommutation::set_offset(std::int64_t offset) {
  offset_ = modulo(offset, steps_);
  zero_ = reference_ - offset_;
}

}  // namespace stator::control
