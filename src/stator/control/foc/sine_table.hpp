#pragma once

#include <cstdint>

namespace stator::control::foc {

/// Sine and cosine in Q30: 2^30 is 1.
struct SineCosine {
  std::int32_t sine;
  std::int32_t cosine;
};

inline constexpr int kSineBits = 30;

/// Angles of 1/256 and of 1/65536 revolution, whose sum is any 16-bit angle.
struct SineTables {
  SineCosine coarse[256];
  SineCosine fine[256];
};
extern const SineTables kSineTables;  // NOLINT(readability-identifier-naming): a constant

/// Sine and cosine of a 16-bit angle, 65536 = one revolution. Error: below 2 LSB of 2^30; rounded
/// to Q15 below 0.5001 LSB.
[[nodiscard]] inline SineCosine sine_cosine(std::uint16_t angle) {
  const SineCosine& a = kSineTables.coarse[angle >> 8U];
  const SineCosine& b = kSineTables.fine[angle & 0xFFU];
  constexpr std::int64_t kHalf = std::int64_t{1} << (kSineBits - 1);
  const std::int64_t sine =
      std::int64_t{a.sine} * b.cosine + std::int64_t{a.cosine} * b.sine + kHalf;
  const std::int64_t cosine =
      std::int64_t{a.cosine} * b.cosine - std::int64_t{a.sine} * b.sine + kHalf;
  return {static_cast<std::int32_t>(sine >> kSineBits),
          static_cast<std::int32_t>(cosine >> kSineBits)};
}

/// Angle of the vector (x, y), 65536 = one revolution; 0 for the zero vector. |x|, |y| <= 2^20.
/// Error: below 0.6 LSB.
[[nodiscard]] std::uint16_t arc_tangent(std::int32_t y, std::int32_t x);

}  // namespace stator::control::foc
