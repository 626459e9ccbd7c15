#include "stator/control/stepper/rotor_observer.hpp"

#include <cmath>

namespace stator::control {

namespace {

constexpr double kTimeConstant = 1e-3;          // s
constexpr double kQuickTimeConstant = 0.25e-3;  // s
constexpr base::SimDuration kStillTime{20'000'000};

}  // namespace

void RotorObserver::set_scale(const EncoderScale& scale) {
  if (scale == scale_) {
    return;
  }
  const std::int64_t whole = base_ + static_cast<std::int64_t>(std::floor(within_ + 0.5));
  scale_ = scale;
  signed_steps_per_revolution_ =
      scale.reversed ? -scale.steps_per_revolution : scale.steps_per_revolution;
  steps_per_count_ = static_cast<double>(signed_steps_per_revolution_) /
                     static_cast<double>(scale.counts_per_revolution);
  duration_ = base::SimDuration(0);
  place(whole, count_);
}

void RotorObserver::place(std::int64_t position, std::int64_t count) {
  base_ = position;
  base_count_ = count;
  count_ = count;
  within_ = 0.0;
  velocity_ = 0.0;
  quick_velocity_ = 0.0;
  still_ = 0;
}

void RotorObserver::set_duration(base::SimDuration duration) {
  duration_ = duration;
  seconds_ = duration.seconds();
  steps_per_second_ = seconds_ > 0.0 ? steps_per_count_ / seconds_ : 0.0;
  smoothing_ = seconds_ / (seconds_ + kTimeConstant);
  quick_smoothing_ = seconds_ / (seconds_ + kQuickTimeConstant);
  still_limit_ = seconds_ > 0.0 ? static_cast<int>(kStillTime.seconds() / seconds_) : 0;
}

void RotorObserver::advance(std::int64_t count, base::SimDuration duration) {
  if (duration != duration_) {
    set_duration(duration);
  }
  const std::int64_t came = count - count_;
  count_ = count;
  const double velocity = static_cast<double>(came) * steps_per_second_;
  velocity_ += smoothing_ * (velocity - velocity_);
  quick_velocity_ += quick_smoothing_ * (velocity - quick_velocity_);
  if (came != 0) {
    still_ = 0;
  } else if (++still_ >= still_limit_) {
    velocity_ = 0.0;
  }
  std::int64_t turned = count - base_count_;
  while (turned >= scale_.counts_per_revolution) {
    turned -= scale_.counts_per_revolution;
    base_count_ += scale_.counts_per_revolution;
    base_ += signed_steps_per_revolution_;
  }
  while (turned <= -scale_.counts_per_revolution) {
    turned += scale_.counts_per_revolution;
    base_count_ -= scale_.counts_per_revolution;
    base_ -= signed_steps_per_revolution_;
  }
  within_ = static_cast<double>(turned) * steps_per_count_;
}

std::int64_t RotorObserver::position_of_count_zero() const {
  const std::int64_t revolutions = base_count_ / scale_.counts_per_revolution;
  const std::int64_t rest = base_count_ % scale_.counts_per_revolution;
  return base_ - revolutions * signed_steps_per_revolution_ -
         static_cast<std::int64_t>(std::floor(static_cast<double>(rest) * steps_per_count_ + 0.5));
}

}  // namespace stator::control
