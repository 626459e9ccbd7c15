#pragma once

#include <cstdint>

#include "stator/control/foc/fixed_point.hpp"
#include "stator/control/foc/transforms.hpp"

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
  const auto square = [](std::int32_t x) {
    return static_cast<std::uint32_t>(x) * static_cast<std::uint32_t>(x);
  };
  const bool d_limited = u.d > limit || u.d < -limit;
  const std::int32_t d = d_limited ? (u.d > 0 ? limit : -limit) : u.d;
  const std::uint32_t room = square(limit) - square(d);
  const bool q_limited = square(u.q) > room;
  if (q_limited) [[unlikely]] {
    const std::int32_t rest = square_root(room);
    return {{d, u.q > 0 ? rest : -rest}, d_limited, true};
  }
  return {{d, u.q}, d_limited, false};
}

}  // namespace stator::control::foc
