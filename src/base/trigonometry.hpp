#pragma once

namespace stator::base {

/// Sine and cosine of one angle.
struct SineCosine {
  double sine;
  double cosine;
};

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kTwoPi = 2.0 * kPi;

/// Sine and cosine of `angle` (radian, |angle| <= 1e6). Only addition, multiplication and rounding
/// are used, so the result has the same bits on every compiler and processor, unlike libm's.
/// Error: below 4e-16 for |angle| <= 2 pi; the reduction adds |angle| * 1e-16 beyond.
[[nodiscard]] SineCosine sine_cosine(double angle);

}  // namespace stator::base
