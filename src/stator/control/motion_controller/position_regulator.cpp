#include "stator/control/motion_controller/position_regulator.hpp"

#include <algorithm>

#include "stator/control/motion_controller/motion_controller_units.hpp"
#include "stator/control/rounding.hpp"

namespace stator::control::motion_controller {

namespace {

constexpr std::int32_t kLargestError = 1 << 23;
constexpr std::int64_t kLargestDelta = 127;
constexpr std::uint32_t kLargestFactor = 0xFF'FFFF;
constexpr std::uint16_t kLargestIntegralClip = 32'640;
constexpr std::uint32_t kLargestVelocity = 0x7FFF'FFFF;

std::int64_t clipped(std::int64_t value, std::int64_t limit) {
  return std::clamp(value, -limit, limit);
}

}  // namespace

void PositionRegulator::configure(const RegulatorSettings& settings) {
  settings_ = settings;
  settings_.p = std::min(settings.p, kLargestFactor);
  settings_.i = std::min(settings.i, kLargestFactor);
  settings_.d = std::min(settings.d, kLargestFactor);
  settings_.velocity_clip = std::min(settings.velocity_clip, kLargestVelocity);
  sum_limit_ = std::int64_t{std::min(settings.integral_clip, kLargestIntegralClip)} * 65'536;
  sum_ = clipped(sum_, sum_limit_);
  d_divider_ = settings.d_divider == 0 ? 256 : settings.d_divider;
  to_d_update_ = std::min(to_d_update_, d_divider_);
  if (!settings.enabled) {
    reset();
  }
}

void PositionRegulator::reset() {
  sum_ = 0;
  last_error_ = 0;
  d_part_ = 0;
  result_ = 0;
  hit_ = false;
}

void PositionRegulator::pause(bool paused) {
  paused_ = paused;
  if (paused) {
    reset();
  }
}

void PositionRegulator::advance(std::int32_t error, base::SimDuration period) {
  const std::int32_t before = error_;
  error_ = std::clamp(error, -kLargestError, kLargestError - 1);
  since_update_ += period;
  const std::int64_t count = since_update_ / kRegulatorPeriod;
  since_update_ -= kRegulatorPeriod * count;
  if (!settings_.enabled || paused_ || count == 0) {
    return;
  }
  const bool still = last_error_ == 0 && d_part_ == 0;
  if (before == 0 && error_ == 0 && still) {
    update(0);
    repeat_update(count - 1);
  } else {
    update_many(before, count);
  }
}

/// Makes `count` updates at once, none of which changes the result.
void PositionRegulator::repeat_update(std::int64_t count) {
  correction_ += count * result_;
  to_d_update_ -= count;
  if (to_d_update_ <= 0) {
    to_d_update_ += d_divider_ * (-to_d_update_ / d_divider_ + 1);
  }
}

void PositionRegulator::update_many(std::int32_t before, std::int64_t count) {
  constexpr std::int64_t kHalf = 1 << 15;
  const std::int64_t step = (std::int64_t{error_} - before) * 65'536 / count;
  std::int64_t along = std::int64_t{before} * 65'536 + kHalf;
  for (std::int64_t k = 1; k < count; ++k) {
    along += step;
    update(along >> 16);
  }
  update(error_);
}

void PositionRegulator::update(std::int64_t error) {
  const std::int64_t magnitude = error < 0 ? -error : error;
  hit_ = (hit_ || error == 0) && magnitude < settings_.tolerance;
  if (hit_) {
    error = 0;
    sum_ = 0;
  }
  sum_ = clipped(sum_ + error, sum_limit_);
  if (--to_d_update_ <= 0) {
    to_d_update_ = d_divider_;
    d_part_ = clipped(last_error_ - error, kLargestDelta) * settings_.d;
    last_error_ = error;
  }
  const std::int64_t p_part = saturated(error * settings_.p / 256);
  const std::int64_t i_part = saturated(sum_ / 256 * settings_.i / 256);
  result_ = clipped(saturated(d_part_) - p_part - i_part, settings_.velocity_clip);
  correction_ += result_;
}

}  // namespace stator::control::motion_controller
