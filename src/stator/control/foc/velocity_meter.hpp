#pragma once

#include <array>
#include <cstdint>

#include "stator/control/foc/fixed_point.hpp"

namespace stator::control::foc {

/// VELOCITY_METER_SELECTION.
enum class MeterKind : std::uint8_t { fixed_rate = 0, time_difference = 1 };

/// Velocity from a position of 65536 per revolution, in rpm.
///
/// At a fixed rate: the position is looked at 65536/15 = 4369.07 times a second, whatever the PWM
/// frequency, and what it turned in four of these intervals (915.5 us) is the velocity in rpm:
/// resolution 1 rpm, delay half of that time. Between PWM periods the position is taken to change
/// evenly.
///
/// By time difference (PPTM): once the position has moved by at least
/// VELOCITY_METER_PPTM_MIN_POS_DEV, the velocity is that way over the time it took; after 0.1 s
/// without it is 0.
class VelocityMeter {
 public:
  void configure(MeterKind kind, std::int32_t least_way) {
    kind_ = kind;
    least_way_ = least_way > 1 ? least_way : 1;
  }

  /// The position has turned by `turned` (s16) in `ticks` of 10 ns. Returns the velocity in rpm.
  std::int32_t step(std::int32_t turned, std::int32_t ticks) {
    position_ += static_cast<std::uint32_t>(turned);
    const std::int64_t passed = std::int64_t{ticks} << 16;
    phase_ += passed;
    while (phase_ >= kSamplePeriod) {
      phase_ -= kSamplePeriod;
      sample(turned, passed);
    }
    if (kind_ == MeterKind::time_difference) {
      measure(turned, ticks);
    }
    return velocity();
  }

  [[nodiscard]] std::int32_t velocity() const {
    return kind_ == MeterKind::time_difference ? by_time_ : by_rate_;
  }
  [[nodiscard]] std::int32_t by_time() const { return by_time_; }

 private:
  /// 15 s / 65536 in ticks of 10 ns, times 65536.
  static constexpr std::int64_t kSamplePeriod = 1'500'000'000;

  /// Takes the position phase_ / 65536 ticks ago.
  void sample(std::int32_t turned, std::int64_t passed) {
    const auto since = static_cast<std::int32_t>(std::int64_t{turned} * phase_ / passed);
    const std::uint32_t then = position_ - static_cast<std::uint32_t>(since);
    by_rate_ = static_cast<std::int32_t>(then - samples_[next_]);
    samples_[next_] = then;
    next_ = (next_ + 1U) & 3U;
  }
  void measure(std::int32_t turned, std::int32_t ticks);

  MeterKind kind_ = MeterKind::fixed_rate;
  std::int32_t least_way_ = 1;
  std::uint32_t position_ = 0;
  std::int64_t phase_ = 0;
  std::array<std::uint32_t, 4> samples_{};
  std::uint32_t next_ = 0;
  std::int32_t by_rate_ = 0;
  std::int64_t way_ = 0;
  std::int64_t time_ = 0;  ///< 10 ns
  std::int32_t by_time_ = 0;
};

}  // namespace stator::control::foc
