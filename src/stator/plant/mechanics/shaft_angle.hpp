#pragma once

#include <algorithm>
#include <cstdint>

#include "stator/base/trigonometry.hpp"

namespace stator::plant {

/// The angle of a shaft in electrical periods of its motor: whole periods and the angle within one,
/// so that resolution does not fall with the number of turns. Invariant: 0 <= angle < 2 pi.
struct ElectricalAngle {
  std::int64_t periods = 0;
  double angle = 0.0;  ///< rad, electrical

  friend constexpr bool operator==(const ElectricalAngle&, const ElectricalAngle&) = default;
};

/// `from` turned by `delta` electrical radians; a magnitude above 2 pi is cut to it.
[[nodiscard]] constexpr ElectricalAngle turned(const ElectricalAngle& from, double delta) {
  ElectricalAngle result{from.periods, from.angle + std::clamp(delta, -base::kTwoPi, base::kTwoPi)};
  if (result.angle >= base::kTwoPi) {
    result.angle -= base::kTwoPi;
    ++result.periods;
  } else if (result.angle < 0.0) {
    result.angle += base::kTwoPi;
    --result.periods;
    if (result.angle >= base::kTwoPi) {  // a tiny negative angle rounds up to a whole period
      result.angle = 0.0;
      ++result.periods;
    }
  }
  return result;
}

/// Electrical radians since the zero of the angle, for people and plots; loses resolution far out.
[[nodiscard]] constexpr double electrical_radians(const ElectricalAngle& angle) {
  return static_cast<double>(angle.periods) * base::kTwoPi + angle.angle;
}

}  // namespace stator::plant
