#include "stator/control/stepper/closed_loop_controller.hpp"

#include <algorithm>
#include <cmath>

namespace stator::control {

namespace {

constexpr double kClock = 16e6;                // Hz
constexpr double kRegulatorRate = 16e6 / 128;  // Hz
constexpr double kHalfPeriod = 512.0;          // 180 degree electrical
constexpr double kFullScale = 255.0;
constexpr base::SimDuration kStillTime{100'000'000};
constexpr double kCaughtUp = 0.5;  // lag in which the vector stands on the same microstep

// Damping while catching up and settling: angle per velocity the rotor lacks, with the velocity
// seen over 0.25 ms. About half of critical for rotors of 200 to 300 Hz, and one count of a coarse
// encoder (10000 a revolution) still moves the vector by a tenth of 90 degree only.
constexpr double kDamping = 1.2e-3;  // s
constexpr base::SimDuration kSettlingTime{50'000'000};

/// Nearest whole number; |value| < 2^31. A conversion rounds toward zero, hence the detour.
std::int64_t rounded(double value) {
  constexpr double kPositive = 4294967296.0;
  return static_cast<std::int64_t>(value + (kPositive + 0.5)) -
         static_cast<std::int64_t>(kPositive);
}

}  // namespace

void ClosedLoopController::configure(const ClosedLoopSettings& settings,
                                     const EncoderScale& scale) {
  if (scale != encoder_) {
    encoder_ = scale;
    rotor_.set_scale(scale);
    stop();
  }
  if (settings == settings_) {
    return;
  }
  settings_ = settings;
  prepare();
  if (duration_ > base::SimDuration(0)) {
    prepare_step(duration_);
  }
}

void ClosedLoopController::prepare() {
  tolerance_ = settings_.tolerance;
  gain_ = settings_.position_gain / 65536.0;
  inverse_gain_ = gain_ > 0.0 ? 1.0 / gain_ : 0.0;
  beta_ = settings_.beta;
  const bool weakens = settings_.weakening_start > 0.0 || settings_.weakening_range > 0.0;
  gamma_ = weakens ? settings_.gamma : 0.0;
  // A range of 0 is a step: a slope that exceeds any gamma within one unit of velocity.
  weakening_slope_ =
      settings_.weakening_range > 0.0 ? gamma_ / settings_.weakening_range : kFullScale;
  minimum_scale_ = settings_.minimum_scale;
  maximum_scale_ = settings_.maximum_scale;
  scale_slope_ = beta_ > 0.0 ? (maximum_scale_ - minimum_scale_) / beta_ : 0.0;
  catch_up_gain_ = settings_.catch_up_gain / 256.0;
  catch_up_integral_ = settings_.catch_up_integral / 65536.0;
  error_sum_limit_ = settings_.error_sum_limit * 65536.0;
}

void ClosedLoopController::prepare_step(base::SimDuration duration) {
  duration_ = duration;
  seconds_ = duration.seconds();
  const auto scale_step = [this](std::uint32_t delay) {
    return delay == 0 ? kFullScale : std::min(kFullScale, seconds_ * kClock / delay);
  };
  upscale_step_ = scale_step(settings_.upscale_delay);
  downscale_step_ = scale_step(settings_.downscale_delay);
  samples_per_step_ = seconds_ * kRegulatorRate;
}

void ClosedLoopController::start() {
  phase_ = Phase::initialising;
  still_ = base::SimDuration(0);
}

void ClosedLoopController::set_commutation_offset(std::int32_t offset) {
  rotor_.shift(std::int64_t{offset} - offset_);
  offset_ = offset;
}

void ClosedLoopController::await_stillness(const Input& input, base::SimDuration duration) {
  const std::int64_t moved = input.encoder_count - still_count_;
  if (!input.may_initialise || moved > 1 || moved < -1) {
    still_count_ = input.encoder_count;
    still_ = base::SimDuration(0);
    return;
  }
  still_ += duration;
  if (still_ >= kStillTime) {
    begin(input);
  }
}

void ClosedLoopController::begin(const Input& input) {
  phase_ = Phase::active;
  rotor_.place(input.setpoint, input.encoder_count);
  offset_ = static_cast<std::int32_t>(rotor_.position_of_count_zero());
  lag_ = 0.0;
  error_sum_ = 0.0;
  damping_left_ = base::SimDuration(0);
  angle_ = 0.0;
  deviation_ = 0.0;
  scale_ = kFullScale;
}

ClosedLoopController::Commutation ClosedLoopController::advance(const Input& input,
                                                                base::SimDuration duration) {
  if (phase_ == Phase::initialising) {
    await_stillness(input, duration);
    return {input.setpoint, 1.0};
  }
  if (duration != duration_) {
    prepare_step(duration);
  }
  rotor_.advance(input.encoder_count, duration);
  // The currents get to their targets at the end of the step, and the set-point is that of its
  // end: so is the rotor.
  const double within = rotor_.within() + rotor_.way_per_step();
  deviation_ = static_cast<double>(input.setpoint - rotor_.base()) - within;
  double current = 0.0;
  if (input.torque) {
    lag_ = 0.0;
    error_sum_ = 0.0;
    angle_ = *input.torque == 0.0 ? 0.0 : std::copysign(limit_toward(*input.torque), *input.torque);
    current = std::min(std::fabs(*input.torque), 1.0);
    scale_ = kFullScale * current;
  } else {
    catch_up();
    angle_ = follow_set_point(input.velocity);
    scale_current();
    current = static_cast<double>(current_scale()) * (1.0 / kFullScale);
  }
  return {rotor_.base() + rounded(within + angle_), current};
}

double ClosedLoopController::limit_at(double velocity) const {
  const double excess = velocity - settings_.weakening_start;
  if (excess <= 0.0) {
    return beta_;
  }
  return std::min(beta_ + std::min(excess * weakening_slope_, gamma_), kHalfPeriod);
}

void ClosedLoopController::catch_up() {
  correction_ = 0.0;
  if (lag_ == 0.0) {
    return;
  }
  error_sum_ =
      std::clamp(error_sum_ + lag_ * samples_per_step_, -error_sum_limit_, error_sum_limit_);
  const double correction = std::clamp(catch_up_gain_ * lag_ + catch_up_integral_ * error_sum_,
                                       -settings_.catch_up_velocity, settings_.catch_up_velocity);
  if (correction * lag_ > 0.0) {  // toward the ramp only: a limit of velocity does not swing
    correction_ = correction;
  }
  const double remaining = lag_ - correction_ * seconds_;
  if (remaining * lag_ <= 0.0 || std::fabs(remaining) < kCaughtUp) {
    lag_ = 0.0;
    error_sum_ = 0.0;
  } else {
    lag_ = remaining;
  }
}

double ClosedLoopController::follow_set_point(double velocity) {
  const double distance = deviation_ - lag_;
  const bool tolerated = std::fabs(distance) <= tolerance_;
  const double gain = tolerated ? 1.0 : gain_;
  double angle = gain * distance;
  const double limit = limit_toward(angle);
  if (std::fabs(angle) > limit) {
    angle = std::copysign(limit, angle);
    lag_ = deviation_ - (tolerated ? angle : angle * inverse_gain_);
  }
  if (lag_ != 0.0) {
    damping_left_ = kSettlingTime;
  } else if (damping_left_ > base::SimDuration(0)) {
    damping_left_ = damping_left_ - duration_;
  } else {
    return angle;
  }
  return damped(angle, gain, velocity + correction_);
}

double ClosedLoopController::damped(double angle, double gain, double velocity) {
  const double lead = kDamping * (velocity - rotor_.quick_velocity());
  // What the lead takes of the limit is not left to the set-point in force: it would stand a whole
  // limit ahead when a rotor that was accelerated reaches its velocity, and hurl it beyond.
  const double limit = limit_toward(angle);
  const double room = std::clamp(limit - std::copysign(lead, lead * angle), 0.0, limit);
  if (std::fabs(angle) > room) {
    angle = std::copysign(room, angle);
    lag_ = deviation_ - (gain == 1.0 ? angle : angle * inverse_gain_);
  }
  return std::clamp(angle + lead, -limit_toward(-1.0), limit_toward(1.0));
}

void ClosedLoopController::scale_current() {
  const double angle = std::fabs(angle_);
  const double wanted = angle < beta_ ? minimum_scale_ + scale_slope_ * angle : maximum_scale_;
  scale_ = wanted > scale_ ? std::min(wanted, scale_ + upscale_step_)
                           : std::max(wanted, scale_ - downscale_step_);
}

}  // namespace stator::control
