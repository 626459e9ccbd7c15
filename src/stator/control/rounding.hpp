#pragma once

#include <bit>
#include <cstdint>

#include "stator/control/pair.hpp"

namespace stator::control {

/// Nearest integer, ties to even; |value| < 2^51. Adding 1.5 * 2^52 rounds without a library call,
/// in the same way on every processor.
[[nodiscard]] constexpr std::int64_t nearest_integer(double value) {
  constexpr double kRounder = 0x1.8p52;
  return std::bit_cast<std::int64_t>(value + kRounder) - std::bit_cast<std::int64_t>(kRounder);
}

/// The same of two, still as floating-point numbers.
[[nodiscard]] inline Pair nearest_integers(Pair value) {
  constexpr double kRounder = 0x1.8p52;
  return (value + kRounder) - kRounder;
}

/// `value` within the range of an INTEGER32 object.
[[nodiscard]] constexpr std::int32_t saturated(std::int64_t value) {
  return value > INT32_MAX   ? INT32_MAX
         : value < INT32_MIN ? INT32_MIN
                             : static_cast<std::int32_t>(value);
}

}  // namespace stator::control
