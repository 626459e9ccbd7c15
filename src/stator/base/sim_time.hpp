#pragma once

#include <compare>
#include <cstdint>
#include <limits>

namespace stator::base {

/// A span of simulated time in integer nanoseconds; addition and subtraction saturate.
/// Range: +-292 years. A double never holds simulated time, so a run can be of any length without
/// losing resolution.
class SimDuration {
 public:
  constexpr SimDuration() = default;
  constexpr explicit SimDuration(std::int64_t nanoseconds) : nanoseconds_(nanoseconds) {}

  static constexpr SimDuration max() {
    return SimDuration(std::numeric_limits<std::int64_t>::max());
  }

  [[nodiscard]] constexpr std::int64_t nanoseconds() const { return nanoseconds_; }
  /// Seconds as a double, for physics and for people; not for bookkeeping.
  [[nodiscard]] constexpr double seconds() const {
    return static_cast<double>(nanoseconds_) * 1e-9;
  }

  friend constexpr auto operator<=>(SimDuration, SimDuration) = default;

  friend constexpr SimDuration operator+(SimDuration a, SimDuration b) {
    std::int64_t sum = 0;
    if (__builtin_add_overflow(a.nanoseconds_, b.nanoseconds_, &sum)) {
      return SimDuration(a.nanoseconds_ < 0 ? std::numeric_limits<std::int64_t>::min()
                                            : std::numeric_limits<std::int64_t>::max());
    }
    return SimDuration(sum);
  }
  friend constexpr SimDuration operator-(SimDuration a, SimDuration b) {
    std::int64_t difference = 0;
    if (__builtin_sub_overflow(a.nanoseconds_, b.nanoseconds_, &difference)) {
      return SimDuration(a.nanoseconds_ < 0 ? std::numeric_limits<std::int64_t>::min()
                                            : std::numeric_limits<std::int64_t>::max());
    }
    return SimDuration(difference);
  }
  friend constexpr SimDuration operator*(SimDuration a, std::int64_t n) {
    std::int64_t product = 0;
    if (__builtin_mul_overflow(a.nanoseconds_, n, &product)) {
      return SimDuration((a.nanoseconds_ < 0) == (n < 0)
                             ? std::numeric_limits<std::int64_t>::max()
                             : std::numeric_limits<std::int64_t>::min());
    }
    return SimDuration(product);
  }
  /// Whole number of times `b` fits into `a`, rounded towards zero; `b` must not be zero.
  friend constexpr std::int64_t operator/(SimDuration a, SimDuration b) {
    return a.nanoseconds_ / b.nanoseconds_;
  }
  friend constexpr SimDuration operator%(SimDuration a, SimDuration b) {
    return SimDuration(a.nanoseconds_ % b.nanoseconds_);
  }
  constexpr SimDuration& operator+=(SimDuration other) { return *this = *this + other; }
  constexpr SimDuration& operator-=(SimDuration other) { return *this = *this - other; }

 private:
  std::int64_t nanoseconds_ = 0;
};

/// A moment in simulated time: integer nanoseconds since the rack's power-on.
class SimTime {
 public:
  constexpr SimTime() = default;
  constexpr explicit SimTime(SimDuration since_power_on) : since_power_on_(since_power_on) {}

  /// "Never": later than every moment a rack can reach; the deadline of something not armed.
  static constexpr SimTime never() { return SimTime(SimDuration::max()); }

  [[nodiscard]] constexpr SimDuration since_power_on() const { return since_power_on_; }
  [[nodiscard]] constexpr std::int64_t nanoseconds() const { return since_power_on_.nanoseconds(); }
  [[nodiscard]] constexpr double seconds() const { return since_power_on_.seconds(); }

  friend constexpr auto operator<=>(SimTime, SimTime) = default;

  friend constexpr SimTime operator+(SimTime t, SimDuration d) {
    return SimTime(t.since_power_on_ + d);
  }
  friend constexpr SimTime operator-(SimTime t, SimDuration d) {
    return SimTime(t.since_power_on_ - d);
  }
  friend constexpr SimDuration operator-(SimTime a, SimTime b) {
    return a.since_power_on_ - b.since_power_on_;
  }
  constexpr SimTime& operator+=(SimDuration d) { return *this = *this + d; }

 private:
  SimDuration since_power_on_;
};

inline namespace literals {
constexpr SimDuration operator""_ns(unsigned long long n) {
  return SimDuration(static_cast<std::int64_t>(n));
}
constexpr SimDuration operator""_us(unsigned long long n) {
  return SimDuration(static_cast<std::int64_t>(n) * 1'000);
}
constexpr SimDuration operator""_ms(unsigned long long n) {
  return SimDuration(static_cast<std::int64_t>(n) * 1'000'000);
}
constexpr SimDuration operator""_s(unsigned long long n) {
  return SimDuration(static_cast<std::int64_t>(n) * 1'000'000'000);
}
}  // namespace literals

}  // namespace stator::base
