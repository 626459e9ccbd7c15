#pragma once

#include <cstdint>

namespace stator::control {

/// Watches the heat of a winding (TMCC160 2095h, A-50): the sum of current squared over the last
/// time constant, forgotten exponentially,
///   d sum / dt = i^2 - sum / time constant,
/// hence i^2 * time constant in the long run. A sum above the limit sets `exceeded`, which stays
/// until cleared; cleared while the sum is above the limit, it is set again at the next step. The
/// counter grows when the flag is set and once more for every second it stays.
class I2tMonitor {
 public:
  /// Time constant in ms (0: the sum stays 0), limit in A^2 ms.
  void configure(std::uint32_t time_constant, std::uint32_t limit) {
    forgetting_ = time_constant == 0 ? 1.0 : 1.0 / time_constant;
    enabled_ = time_constant == 0 ? 0.0 : 1.0;
    limit_ = limit;
  }
  /// Lets a millisecond pass with a mean of the squared current of `square_current` A^2.
  void pass_millisecond(double square_current) {
    sum_ = sum_ - sum_ * forgetting_ + square_current * enabled_;
    if (!exceeded_) {
      if (sum_ > limit_) {
        exceeded_ = true;
        ++counter_;
        milliseconds_ = 0;
      }
    } else if (++milliseconds_ == 1000) {
      milliseconds_ = 0;
      ++counter_;
    }
    // A sum that fades for minutes must not end in slow subnormal numbers.
    sum_ = sum_ < 1e-9 ? 0.0 : sum_;
  }

  [[nodiscard]] std::uint32_t sum() const {
    constexpr double kLargest = 4294967295.0;
    return static_cast<std::uint32_t>(sum_ < kLargest ? sum_ : kLargest);
  }
  [[nodiscard]] bool exceeded() const { return exceeded_; }
  void clear_exceeded() { exceeded_ = false; }
  [[nodiscard]] std::uint32_t counter() const { return counter_; }
  void set_counter(std::uint32_t value) { counter_ = value; }

 private:
  double forgetting_ = 1.0;
  double enabled_ = 0.0;
  double limit_ = 0.0;
  double sum_ = 0.0;
  std::uint32_t counter_ = 0;
  std::uint32_t milliseconds_ = 0;
  bool exceeded_ = false;
};

}  // namespace stator::control
