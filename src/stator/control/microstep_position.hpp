#pragma once

#include <cstdint>

namespace stator::control {

/// A position as whole microsteps and a fraction of one, so that it keeps its resolution after any
/// number of turns. Invariant: 0 <= fraction < 1; the value is microsteps + fraction, hence the
/// whole part is the floor, also below zero.
///
/// The whole part is not wrapped: an axis may turn in one direction for years (2^63 microsteps at
/// 8 Mpps: 36000 years). Where a device's objects are INTEGER32, the firmware narrows when it
/// reports (static_cast<std::int32_t> wraps as the counter of a chip does) and widens when it takes
/// a target.
struct MicrostepPosition {
  std::int64_t microsteps = 0;
  double fraction = 0.0;

  friend constexpr bool operator==(const MicrostepPosition&, const MicrostepPosition&) = default;
};

/// `from` moved by `displacement` microsteps (|displacement| < 2^62).
[[nodiscard]] constexpr MicrostepPosition displaced(const MicrostepPosition& from,
                                                    double displacement) {
  const double sum = from.fraction + displacement;
  auto whole = static_cast<std::int64_t>(sum);  // towards zero, which is above a negative sum
  double fraction = sum - static_cast<double>(whole);
  if (fraction < 0.0) {
    fraction += 1.0;
    --whole;
    if (fraction >= 1.0) {  // a tiny negative sum rounds up to the next whole microstep
      fraction = 0.0;
      ++whole;
    }
  }
  return {from.microsteps + whole, fraction};
}

/// `to` - `from` in microsteps; exact to 2^-52 of the distance.
[[nodiscard]] constexpr double distance(const MicrostepPosition& from,
                                        const MicrostepPosition& to) {
  return static_cast<double>(to.microsteps - from.microsteps) + (to.fraction - from.fraction);
}

}  // namespace stator::control
