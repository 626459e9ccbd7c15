#pragma once

#include <cstdint>

#include "control/foc/fixed_point.hpp"
#include "control/foc/transforms.hpp"

namespace stator::control::foc {

/// What the limiter took.
struct LimitedVoltage {
  RotorVector voltage;
  bool d_limited = false;
  bool q_limited = false;
};

/// Circular limiter in front of the inverse Park transformation (reading A-48): U_D is cut to
/// +/- limit, U_Q to what then remains of the circle. The length of the result never exceeds
/// `limit`, 0..65535; U_Q is within 1 LSB below the exact value.
[[nodiscard]] inline LimitedVoltage limit_circle(const RotorVector& u, std::int32_t limit) {
  LimitedVoltage result{u};
  if (u.d > limit || u.d < -limit) {
    result.voltage.d = u.d > 0 ? limit : -limit;
    result.d_limited = true;
  }
  const auto square = [](std::int32_t x) {
    return static_cast<std::uint32_t>(x) * static_cast<std::uint32_t>(x);
  };
  const std::uint32_t room = square(limit) - square(result.voltage.d);
  if (square(u.q) > room) {
    const std::int32_t rest = square_root(room);
    result.voltage.q = u.q > 0 ? rest : -rest;
    result.q_limited = true;
  }
  return result;
}

}  // namespace stator::control::foc
