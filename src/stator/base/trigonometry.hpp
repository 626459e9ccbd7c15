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
/// Error: below 2.5e-16 in the whole range (1.8e-16 measured).
[[nodiscard]] SineCosine sine_cosine(double angle);

/// Angle of the vector (x, y) in radian, -pi..pi, 0 for the zero vector. Same bits everywhere, like
/// sine_cosine(); error below 1e-15.
[[nodiscard]] double arc_tangent(double y, double x);

}  // namespace stator::base
