#pragma once

#include <cmath>

#include "stator/control/ramp/root_finding.hpp"

namespace stator::control {

/// How speed is changed in one sense: by accelerations up to `rate` that come and go with a jerk.
/// All are magnitudes.
struct Slope {
  Slope(double limit, double jerk_at_start, double jerk_at_end);

  double rate;        ///< pps/s
  double start_jerk;  ///< pps/s^2; 0 = the acceleration steps
  double end_jerk;
  double start_bow;  ///< 1 / jerk, s per pps/s
  double end_bow;
  double bows;  ///< sum of both
};

/// One change of speed: from an acceleration to a peak, held, and to 0. Magnitudes.
struct AccelerationPulse {
  double entry = 0.0;       ///< pps/s
  double peak = 0.0;        ///< pps/s, at most the slope's rate, or entry
  double start_time = 0.0;  ///< s from entry to peak
  double hold_time = 0.0;
  double end_time = 0.0;  ///< s from peak to 0

  /// The shortest that changes the speed by `change` pps, at least what the slope's end bow needs
  /// for `entry`. An entry above the rate comes down with the end bow first.
  static AccelerationPulse over(const Slope& slope, double entry, double change);
  /// With a peak between the entry and the rate, not held.
  static AccelerationPulse with_peak(const Slope& slope, double entry, double peak);

  /// pps by which the speed changes.
  [[nodiscard]] double change() const {
    return 0.5 * (entry + peak) * start_time + peak * (hold_time + 0.5 * end_time);
  }
  /// Microsteps covered from `speed` on; `sense` is +1 when speed is gained, -1 when it is lost.
  [[nodiscard]] double way(double speed, double sense) const {
    const double rise = (1.0 / 6.0) * (peak - entry) + 0.5 * entry;
    const double at_peak = speed + sense * 0.5 * (entry + peak) * start_time;
    const double at_end = at_peak + sense * peak * hold_time;
    return start_time * (speed + sense * start_time * rise) + 0.5 * hold_time * (at_peak + at_end) +
           end_time * (at_end + sense * (1.0 / 3.0) * peak * end_time);
  }
};

/// Microsteps from a speed without acceleration to rest, in closed form.
class StoppingWay {
 public:
  explicit StoppingWay(const Slope& slope);
  [[nodiscard]] double operator()(double speed) const;
  /// And by how much it grows with the speed, s.
  [[nodiscard]] ValueAndSlope with_slope(double speed) const;
  /// The deceleration reaches its rate.
  [[nodiscard]] bool holds(double speed) const { return speed >= held_from_; }
  /// The way as if the deceleration were held, for any speed.
  [[nodiscard]] double held(double speed) const {
    return speed * (speed * half_inverse_rate_ + held_linear_) + held_constant_;
  }
  /// The way as if the deceleration were not limited, for any speed; the true one is never shorter.
  [[nodiscard]] double unlimited(double speed) const;

  // Gaining speed from `speed` on and braking from the peak at once makes a way that grows with how
  // hard or how long speed is gained. These make it `length` microsteps long, at least what
  // braking takes; the ways with the largest values named are at least that long.

  /// Peak of a pulse not held, from `entry` to `highest`.
  [[nodiscard]] double peak_before(double length, double speed, const Slope& slope, double entry,
                                   double highest) const;
  /// Time to hold `pulse`, 0 to `longest` s.
  [[nodiscard]] double hold_before(double length, double speed, const AccelerationPulse& pulse,
                                   double longest) const;

 private:
  double rate_;
  double half_inverse_rate_;
  double inverse_bows_;
  double bow_slope_;    ///< growth of the way of a pulse not held over its peak
  double cubic_;        ///< way of a pulse not held over its peak^3
  double held_from_;    ///< speed from which the pulse is held
  double held_linear_;  ///< of the held pulse: way = speed^2 / (2 rate) + linear * speed + constant
  double held_constant_;
};

/// How far a way found may be from its length, microsteps: what cannot be seen.
[[nodiscard]] inline double way_tolerance(double length) {
  return 1e-9 + 1e-13 * std::fabs(length);
}

}  // namespace stator::control
