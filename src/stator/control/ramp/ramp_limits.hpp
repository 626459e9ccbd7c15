// Shapes of ramps, and their limits in pps, pps/s and pps/s^2.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace stator::control {

enum class RampShape : std::uint8_t {
  six_point,  ///< constant accelerations; without a break velocity a trapezoid
  s_shaped,   ///< constant jerks
};

/// What a ramp may use, in pps, pps/s and pps/s^2. Values that are negative or not a number count
/// as 0, larger ones than named as these.
///
/// Zeros, because a drive that has not been parameterised must not move:
///   deceleration 0: there is no ramp to brake on, so an axis in motion stops at once and one at
///                   rest does not start; the same holds for final_deceleration below a break
///                   velocity;
///   acceleration 0: the axis never gains speed, hence does not start from rest; the same holds for
///                   start_acceleration below a break velocity;
///   velocity 0:     the axis brakes to rest and stays;
///   jerk 0:         no bow at this corner, the acceleration steps there.
struct RampLimits {
  double velocity = 0.0;      ///< up to 1e9
  double acceleration = 0.0;  ///< gaining speed, up to 1e12
  double deceleration = 0.0;  ///< losing speed, up to 1e12

  RampShape shape = RampShape::six_point;

  // Of six-point ramps.
  double start_velocity = 0.0;      ///< from rest the ramp begins with a step to it
  double start_acceleration = 0.0;  ///< below break_velocity, instead of acceleration
  double break_velocity = 0.0;      ///< 0 = one acceleration and one deceleration
  double final_deceleration = 0.0;  ///< below break_velocity, instead of deceleration
  double end_velocity = 0.0;        ///< positioning: the deceleration above ends here
  double stop_deceleration = 0.0;   ///< from end_velocity to rest; 0 = a step

  /// Of s-shaped ramps: at the start of gaining speed, at its end, at the start of losing speed, at
  /// its end; up to 1e15.
  std::array<double, 4> jerk{};

  friend constexpr bool operator==(const RampLimits&, const RampLimits&) = default;

  /// With every value in its range.
  [[nodiscard]] constexpr RampLimits cleaned() const {
    const auto clean = [](double value, double maximum) {
      return value > 0.0 ? std::min(value, maximum) : 0.0;  // also turns "not a number" into 0
    };
    RampLimits result = *this;
    for (double* speed :
         {&result.velocity, &result.start_velocity, &result.break_velocity, &result.end_velocity}) {
      *speed = clean(*speed, 1e9);
    }
    for (double* rate : {&result.acceleration, &result.deceleration, &result.start_acceleration,
                         &result.final_deceleration, &result.stop_deceleration}) {
      *rate = clean(*rate, 1e12);
    }
    for (double& bow : result.jerk) {
      bow = clean(bow, 1e15);
    }
    return result;
  }
};

}  // namespace stator::control
