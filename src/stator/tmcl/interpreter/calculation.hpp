#pragma once

#include <cstdint>

#include "stator/tmcl/interpreter/registers.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tmcl {

/// Operations of CALC and CALCX, under the numbers of their type field.
enum class Operation : std::uint8_t {
  add = 0,
  subtract = 1,
  multiply = 2,
  divide = 3,
  modulo = 4,
  bitwise_and = 5,
  bitwise_or = 6,
  bitwise_xor = 7,
  invert = 8,
  load = 9,
  swap = 10,  ///< of CALCX only
};

/// CALC: accumulator = accumulator `operation` operand, in two's complement of 32 bits that wraps;
/// quotients are truncated as in C (A76). Status::wrong_type: there is no such operation.
/// Status::invalid_value: division by 0, which changes nothing.
[[nodiscard]] Status calculate(Registers& registers, std::uint8_t operation, std::int32_t operand);

/// CALCX: the same with the X register as operand, but NOT gives the inverted X (A77), LOAD copies
/// the accumulator to X, and SWAP exchanges them.
[[nodiscard]] Status calculate_with_x(Registers& registers, std::uint8_t operation);

}  // namespace stator::tmcl
