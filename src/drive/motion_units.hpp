#pragma once

#include <cmath>
#include <cstdint>

namespace stator::drive {

/// The one place where velocity and acceleration objects meet pps and pps/s.
///
/// 208Ch = 181 selects pps and pps/s. 208Ch = 0 selects "internal units", which the TMCM-3315's
/// document does not define; taken as the TMC4361's registers: velocity with 8 and acceleration
/// with 2 fractional bits.
class MotionUnits {
 public:
  MotionUnits() = default;
  static constexpr MotionUnits internal() { return {256.0, 4.0}; }

  /// pps of a velocity object.
  [[nodiscard]] double velocity(double value) const { return value / velocity_scale_; }
  /// pps/s of an acceleration object.
  [[nodiscard]] double acceleration(double value) const { return value / acceleration_scale_; }
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
