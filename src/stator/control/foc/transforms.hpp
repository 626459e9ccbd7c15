#pragma once

#include <cstdint>

#include "stator/control/foc/fixed_point.hpp"
#include "stator/control/foc/sine_table.hpp"

namespace stator::control::foc {

// Clarke, Park and their inverses, amplitude-invariant (reading A-49), in the chip's s16 words.
// Every result is rounded to the nearest and saturated, so it lies within 0.5 LSB of the exact one
// (0.51 LSB where an irrational factor is rounded too) as long as that fits into s16.

/// Fixed to the stator: a along phase U or X, b 90 electrical degrees ahead.
struct StatorVector {
  std::int32_t a = 0;
  std::int32_t b = 0;
};

/// Turning with the rotor: d along its flux, q 90 electrical degrees ahead.
struct RotorVector {
  std::int32_t d = 0;
  std::int32_t q = 0;
};

/// Three phases; their sum is 0 after inverse_clarke().
struct PhaseVector {
  std::int32_t u = 0;
  std::int32_t v = 0;
  std::int32_t w = 0;
};

inline constexpr std::int64_t kInverseSqrt3Q30 = 619925131;
inline constexpr std::int64_t kHalfSqrt3Q30 = 929887697;

/// Clarke transformation of the phases U and V; W is not needed, the sum being 0.
[[nodiscard]] constexpr StatorVector clarke(std::int32_t u, std::int32_t v) {
  return {u, saturate_s16(rounded_shift((std::int64_t{u} + 2 * std::int64_t{v}) * kInverseSqrt3Q30,
                                        kSineBits))};
}

[[nodiscard]] constexpr RotorVector park(const StatorVector& i, const SineCosine& angle) {
  const std::int64_t d = std::int64_t{i.a} * angle.cosine + std::int64_t{i.b} * angle.sine;
  const std::int64_t q = std::int64_t{i.b} * angle.cosine - std::int64_t{i.a} * angle.sine;
  return {saturate_s16(rounded_shift(d, kSineBits)), saturate_s16(rounded_shift(q, kSineBits))};
}

[[nodiscard]] constexpr StatorVector inverse_park(const RotorVector& u, const SineCosine& angle) {
  const std::int64_t a = std::int64_t{u.d} * angle.cosine - std::int64_t{u.q} * angle.sine;
  const std::int64_t b = std::int64_t{u.q} * angle.cosine + std::int64_t{u.d} * angle.sine;
  return {saturate_s16(rounded_shift(a, kSineBits)), saturate_s16(rounded_shift(b, kSineBits))};
}

[[nodiscard]] constexpr PhaseVector inverse_clarke(const StatorVector& u) {
  const std::int64_t half = std::int64_t{u.a} << (kSineBits - 1);
  const auto v =
      static_cast<std::int32_t>(rounded_shift(std::int64_t{u.b} * kHalfSqrt3Q30 - half, kSineBits));
  return {u.a, v, -u.a - v};
}

}  // namespace stator::control::foc
