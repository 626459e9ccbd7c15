#pragma once

#include <cstdint>

namespace stator::tmcl {

/// A command without its way: what a program holds and what every telegram carries. Seven bytes on
/// the wire: command, type, motor, and the value with its most significant byte first.
struct Instruction {
  std::uint8_t command = 0;
  std::uint8_t type = 0;
  std::uint8_t motor = 0;  ///< or bank
  std::int32_t value = 0;

  friend bool operator==(const Instruction&, const Instruction&) = default;
};

}  // namespace stator::tmcl
