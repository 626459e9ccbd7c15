// TMCL's CALC and CALCX against arithmetic of 64 bits, division by zero included.
#include "stator/tmcl/interpreter/calculation.hpp"

#include <array>
#include <limits>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"

namespace stator::tmcl {
namespace {

constexpr std::int32_t kLowest = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kHighest = std::numeric_limits<std::int32_t>::max();

std::int32_t low_32_bits(std::int64_t value) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(value));
}

/// The accumulator as arithmetic of 64 bits has it.
std::int32_t expected(Operation operation, std::int64_t a, std::int64_t b) {
  switch (operation) {
    case Operation::add:
      return low_32_bits(a + b);
    case Operation::subtract:
      return low_32_bits(a - b);
    case Operation::multiply:
      return low_32_bits(a * b);
    case Operation::divide:
      return low_32_bits(b == 0 ? a : a / b);
    case Operation::modulo:
      return low_32_bits(b == 0 ? a : a - a / b * b);
    case Operation::bitwise_and:
      return low_32_bits(a & b);
    case Operation::bitwise_or:
      return low_32_bits(a | b);
    case Operation::bitwise_xor:
      return low_32_bits(a ^ b);
    case Operation::invert:
      return low_32_bits(-1 - a);
    case Operation::load:
      return low_32_bits(b);
    case Operation::swap:
      break;
  }
  return 0;
}

/// Numbers of every size, and those at the ends of the range.
std::int32_t any_number(base::Random& random) {
  constexpr std::array<std::int32_t, 8> kCorners{kLowest, kLowest + 1, -1,    0,
                                                 1,       2,           -5000, kHighest};
  if (random.below(4) == 0) {
    return kCorners[random.below(kCorners.size())];
  }
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(random.next())) >> random.below(31);
}

TEST(TmclCalculation, CalcIsArithmeticOf64BitsCutTo32) {
  base::Random random(20140624);
  for (int i = 0; i < 200'000; ++i) {
    const auto operation = static_cast<Operation>(random.below(10));
    Registers registers{.accumulator = any_number(random), .x = 77};
    const std::int32_t a = registers.accumulator;
    const std::int32_t b = any_number(random);
    const bool by_zero =
        b == 0 && (operation == Operation::divide || operation == Operation::modulo);
    ASSERT_EQ(calculate(registers, static_cast<std::uint8_t>(operation), b),
              by_zero ? Status::invalid_value : Status::success);
    ASSERT_EQ(registers.accumulator, expected(operation, a, b))
        << "operation " << static_cast<int>(operation) << " of " << a << " and " << b;
    ASSERT_EQ(registers.zero, !by_zero && registers.accumulator == 0);
    ASSERT_EQ(registers.x, 77);
  }
}

TEST(TmclCalculation, CalcxTakesXAsOperand) {
  base::Random random(457);
  for (int i = 0; i < 200'000; ++i) {
    const auto operation = static_cast<Operation>(random.below(11));
    Registers registers{.accumulator = any_number(random), .x = any_number(random)};
    const std::int32_t a = registers.accumulator;
    const std::int32_t x = registers.x;
    static_cast<void>(calculate_with_x(registers, static_cast<std::uint8_t>(operation)));
    SCOPED_TRACE(static_cast<int>(operation));
    switch (operation) {
      case Operation::invert:
        ASSERT_EQ(registers.accumulator, low_32_bits(-1 - std::int64_t{x}));
        ASSERT_EQ(registers.x, x) << "X stays";
        break;
      case Operation::load:
        ASSERT_EQ(registers.accumulator, a);
        ASSERT_EQ(registers.x, a);
        break;
      case Operation::swap:
        ASSERT_EQ(registers.accumulator, x);
        ASSERT_EQ(registers.x, a);
        break;
      default:
        ASSERT_EQ(registers.accumulator, expected(operation, a, x));
        ASSERT_EQ(registers.x, x);
    }
  }
}

TEST(TmclCalculation, QuotientsAreTruncatedAndTheRestHasTheSignOfTheDividend) {
  Registers registers{.accumulator = -7};
  EXPECT_EQ(calculate(registers, 3, 2), Status::success);
  EXPECT_EQ(registers.accumulator, -3);
  registers.accumulator = -7;
  EXPECT_EQ(calculate(registers, 4, 2), Status::success);
  EXPECT_EQ(registers.accumulator, -1);
  registers.accumulator = kLowest;
  EXPECT_EQ(calculate(registers, 3, -1), Status::success);
  EXPECT_EQ(registers.accumulator, kLowest) << "wraps";
  EXPECT_EQ(calculate(registers, 4, -1), Status::success);
  EXPECT_EQ(registers.accumulator, 0);
}

TEST(TmclCalculation, DivisionByZeroChangesNothing) {
  for (const std::uint8_t operation : {std::uint8_t{3}, std::uint8_t{4}}) {
    Registers registers{.accumulator = 12, .zero = false};
    const Registers before = registers;
    EXPECT_EQ(calculate(registers, operation, 0), Status::invalid_value);
    EXPECT_EQ(calculate_with_x(registers, operation), Status::invalid_value);
    EXPECT_EQ(registers, before);
  }
}

TEST(TmclCalculation, UnknownOperationsAreRefused) {
  Registers registers{.accumulator = 12, .x = 3};
  const Registers before = registers;
  EXPECT_EQ(calculate(registers, 10, 5), Status::wrong_type) << "SWAP is one of CALCX";
  EXPECT_EQ(calculate(registers, 255, 5), Status::wrong_type);
  EXPECT_EQ(calculate_with_x(registers, 11), Status::wrong_type);
  EXPECT_EQ(registers, before);
}

}  // namespace
}  // namespace stator::tmcl
