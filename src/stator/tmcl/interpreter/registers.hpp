#pragma once

#include <cstdint>

namespace stator::tmcl {

/// Flags that tell a program of errors, under the numbers CLE gives them; JC's are higher by 7
/// (A79).
enum class ErrorFlag : std::uint8_t {
  timeout = 1,         ///< ETO: the time-out of a WAIT
  external_alarm = 2,  ///< EAL: error of the driver
  deviation = 3,       ///< EDV: stopped because the encoder deviates
  position = 4,        ///< EPO: position error or limit
  shutdown = 5,        ///< ESD: the shutdown input
};
inline constexpr std::uint8_t kErrorFlagCount = 5;

/// What commands calculate with. One set for programs and direct mode (A110).
struct Registers {
  std::int32_t accumulator = 0;
  std::int32_t x = 0;
  /// The accumulator was 0 after the latest calculation, comparison or reading command (A78).
  bool zero = false;
  /// The accumulator beside the operand of the latest COMP.
  bool equal = false;
  bool lower = false;
  bool greater = false;
  std::uint8_t errors = 0;  ///< bit n: ErrorFlag n

  void load(std::int32_t value) {
    accumulator = value;
    zero = value == 0;
  }
  void compare(std::int32_t operand) {
    zero = equal = accumulator == operand;
    lower = accumulator < operand;
    greater = accumulator > operand;
  }

  void raise(ErrorFlag flag) { errors |= bit_of(flag); }
  void clear(ErrorFlag flag) { errors &= static_cast<std::uint8_t>(~bit_of(flag)); }
  [[nodiscard]] bool raised(ErrorFlag flag) const { return errors & bit_of(flag); }

  friend bool operator==(const Registers&, const Registers&) = default;

 private:
  static constexpr std::uint8_t bit_of(ErrorFlag flag) {
    return static_cast<std::uint8_t>(1U << static_cast<unsigned>(flag));
  }
};

}  // namespace stator::tmcl
