#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace stator::drive {

/// The one place where velocity and acceleration objects meet pps and pps/s.
///
/// 208Ch = 181 selects pps and pps/s. 208Ch = 0 selects "internal units", which the TMCM-3315's
/// document does not define; taken as the TMC4361's registers: velocity with 8 and acceleration
/// with 2 fractional bits. Jerks are whole pps/s^2 in both.
///
/// Objects take what their ranges allow; what the ramp generator cannot hold is clipped here.
class MotionUnits {
 public:
  // What the TMC4361 can hold in its frequency mode: 23 and 22 integer bits.
  static constexpr double kMaximumVelocity = 8'388'607.0;      ///< pps
  static constexpr double kMaximumAcceleration = 4'194'303.0;  ///< pps/s
  /// pps/s^2: 2^20 / 2^53 * (16 MHz)^3 (TMCM-3315 CoE manual L897, which prints 467.837e9).
  static constexpr double kMaximumJerk = 476.837e9;

  MotionUnits() = default;
  static constexpr MotionUnits internal() { return {256.0, 4.0}; }

  /// pps of a velocity object, more than the ramp generator can hold included.
  [[nodiscard]] double pps(double value) const { return value / velocity_scale_; }
  /// pps of a velocity object, clipped to what the ramp generator can hold.
  [[nodiscard]] double velocity(double value) const {
    return std::clamp(pps(value), -kMaximumVelocity, kMaximumVelocity);
  }
  /// pps/s of an acceleration object.
  [[nodiscard]] double acceleration(double value) const {
    return std::min(value / acceleration_scale_, kMaximumAcceleration);
  }
  /// pps/s^2 of a jerk object multiplied by the bow scaling factor 2015h.
  [[nodiscard]] static double jerk(double value, double factor) {
    return std::min(value * factor, kMaximumJerk);
  }
  /// Value of a velocity object for `pps`, rounded to the nearest, saturated to INTEGER32.
  [[nodiscard]] std::int32_t velocity_object(double pps) const {
    constexpr double kMaximum = 2147483647.0;
    const double value = std::floor(pps * velocity_scale_ + 0.5);
    return static_cast<std::int32_t>(value < -kMaximum  ? -kMaximum
                                     : value > kMaximum ? kMaximum
                                                        : value);
  }

 private:
  constexpr MotionUnits(double velocity_scale, double acceleration_scale)
      : velocity_scale_(velocity_scale), acceleration_scale_(acceleration_scale) {}

  double velocity_scale_ = 1.0;
  double acceleration_scale_ = 1.0;
};

}  // namespace stator::drive
