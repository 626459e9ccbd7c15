#include "stator/tmcl/interpreter/calculation.hpp"

#include <utility>

namespace stator::tmcl {

namespace {

std::uint32_t bits(std::int32_t value) {
  return static_cast<std::uint32_t>(value);
}

std::int32_t wrap(std::uint32_t value) {
  return static_cast<std::int32_t>(value);
}

/// `operand` is not 0. 64 bits, because the lowest number divided by -1 is no number of 32 bits.
std::int32_t quotient(std::int32_t accumulator, std::int32_t operand) {
  return static_cast<std::int32_t>(std::int64_t{accumulator} / operand);
}

std::int32_t remainder(std::int32_t accumulator, std::int32_t operand) {
  return static_cast<std::int32_t>(std::int64_t{accumulator} % operand);
}

}  // namespace

Status calculate(Registers& registers, std::uint8_t operation, std::int32_t operand) {
  const std::int32_t a = registers.accumulator;
  switch (static_cast<Operation>(operation)) {
    case Operation::add:
      registers.load(wrap(bits(a) + bits(operand)));
      return Status::success;
    case Operation::subtract:
      registers.load(wrap(bits(a) - bits(operand)));
      return Status::success;
    case Operation::multiply:
      registers.load(wrap(bits(a) * bits(operand)));
      return Status::success;
    case Operation::divide:
      if (operand == 0) {
        return Status::invalid_value;
      }
      registers.load(quotient(a, operand));
      return Status::success;
    case Operation::modulo:
      if (operand == 0) {
        return Status::invalid_value;
      }
      registers.load(remainder(a, operand));
      return Status::success;
    case Operation::bitwise_and:
      registers.load(wrap(bits(a) & bits(operand)));
      return Status::success;
    case Operation::bitwise_or:
      registers.load(wrap(bits(a) | bits(operand)));
      return Status::success;
    case Operation::bitwise_xor:
      registers.load(wrap(bits(a) ^ bits(operand)));
      return Status::success;
    case Operation::invert:
      registers.load(wrap(~bits(a)));
      return Status::success;
    case Operation::load:
      registers.load(operand);
      return Status::success;
    case Operation::swap:
      break;
  }
  return Status::wrong_type;
}

Status calculate_with_x(Registers& registers, std::uint8_t operation) {
  switch (static_cast<Operation>(operation)) {
    case Operation::invert:
      registers.load(wrap(~bits(registers.x)));
      return Status::success;
    case Operation::load:
      registers.x = registers.accumulator;
      registers.load(registers.accumulator);
      return Status::success;
    case Operation::swap: {
      const std::int32_t x = std::exchange(registers.x, registers.accumulator);
      registers.load(x);
      return Status::success;
    }
    default:
      return calculate(registers, operation, registers.x);
  }
}

}  // namespace stator::tmcl
