#include "stator/control/foc/biquad.hpp"

namespace stator::control::foc {

std::int32_t Biquad::filter(std::int32_t x) {
  // Five products of 32 by 32 bits do not fit into 64; the coefficients are taken in two halves.
  std::int64_t high = 0;
  std::int64_t low = remainder_;
  const auto add = [&](std::int32_t coefficient, std::int32_t value) {
    high += std::int64_t{coefficient >> 16} * value;
    low += std::int64_t{coefficient & 0xFFFF} * value;
  };
  add(c_.b0, x);
  add(c_.b1, x1_);
  add(c_.b2, x2_);
  add(c_.a1, y1_);
  add(c_.a2, y2_);
  high += low >> 16;
  constexpr int kRest = kFractionBits - 16;
  const std::int64_t exact = high >> kRest;
  const std::int32_t y = saturate_s32(exact);
  remainder_ = y == exact ? ((high & ((std::int64_t{1} << kRest) - 1)) << 16) | (low & 0xFFFF) : 0;
  x2_ = x1_;
  x1_ = x;
  y2_ = y1_;
  y1_ = y;
  return y;
}

}  // namespace stator::control::foc
