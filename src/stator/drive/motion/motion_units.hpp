#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace stator::drive {

/// The one place where velocity and acceleration objects meet pps and pps/s. A pulse is an
/// increment of the position: a microstep of a stepper axis, an encoder count or hall step of a
/// servo axis.
///
/// Of a stepper axis, 208Ch = 181 selects pps and pps/s. 208Ch = 0 selects "internal units", which
/// the TMCM-3315's document does not define; taken as the TMC4361's registers: velocity with 8 and
/// acceleration with 2 fractional bits. Jerks are whole pps/s^2 in both. Servo axes count in rpm
/// and rpm/s.
///
/// Objects take what their ranges allow; what the ramp generator cannot hold, or a limit of the
/// product forbids, is clipped here.
class MotionUnits {
 public:
  /// Of a servo axis' velocity objects per revolution per second, and of its acceleration objects
  /// the same per second: rpm.
  static constexpr double kSecondsPerMinute = 60.0;

  // What the TMC4361 can hold in its frequency mode: 23 and 22 integer bits.
  static constexpr double kMaximumVelocity = 8'388'607.0;      ///< pps
  static constexpr double kMaximumAcceleration = 4'194'303.0;  ///< pps/s
  /// pps/s^2: 2^20 / 2^53 * (16 MHz)^3 (TMCM-3315 CoE manual L897, which prints 467.837e9).
  static constexpr double kMaximumJerk = 476.837e9;

  MotionUnits() = default;
  static constexpr MotionUnits internal() {
    return {256.0, 4.0, kMaximumVelocity, kMaximumAcceleration};
  }
  /// Objects of a motor whose position has `resolution` (more than 0) increments per revolution,
  /// with the largest velocity and acceleration (as the objects have them) that any ramp may use.
  /// `per_revolution` (more than 0) units of velocity are a revolution per second, and the same of
  /// acceleration a revolution per second squared.
  static constexpr MotionUnits rotational(double resolution, double maximum_velocity,
                                          double maximum_acceleration,
                                          double per_revolution = kSecondsPerMinute) {
    const double scale = per_revolution / resolution;
    return {scale, scale, maximum_velocity / scale, maximum_acceleration / scale};
  }

  [[nodiscard]] double maximum_velocity() const { return maximum_velocity_; }          ///< pps
  [[nodiscard]] double maximum_acceleration() const { return maximum_acceleration_; }  ///< pps/s

  /// pps of a velocity object, more than the ramp generator can hold included.
  [[nodiscard]] double pps(double value) const { return value / velocity_scale_; }
  /// pps of a velocity object, clipped to what the ramp generator can hold.
  [[nodiscard]] double velocity(double value) const {
    return std::clamp(pps(value), -maximum_velocity_, maximum_velocity_);
  }
  /// pps/s of an acceleration object.
  [[nodiscard]] double acceleration(double value) const {
    return std::min(value / acceleration_scale_, maximum_acceleration_);
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
  constexpr MotionUnits(double velocity_scale, double acceleration_scale, double maximum_velocity,
                        double maximum_acceleration)
      : velocity_scale_(velocity_scale),
        acceleration_scale_(acceleration_scale),
        maximum_velocity_(maximum_velocity),
        maximum_acceleration_(maximum_acceleration) {}

  double velocity_scale_ = 1.0;
  double acceleration_scale_ = 1.0;
  double maximum_velocity_ = kMaximumVelocity;
  double maximum_acceleration_ = kMaximumAcceleration;
};

}  // namespace stator::drive
