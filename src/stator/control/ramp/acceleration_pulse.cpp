#include "stator/control/ramp/acceleration_pulse.hpp"

#include <algorithm>
#include <cmath>

namespace stator::control {

namespace {

double inverse(double value) {
  return value > 0.0 ? 1.0 / value : 0.0;
}

}  // namespace

Slope::Slope(double limit, double jerk_at_start, double jerk_at_end)
    : rate(limit),
      start_jerk(jerk_at_start),
      end_jerk(jerk_at_end),
      start_bow(inverse(jerk_at_start)),
      end_bow(inverse(jerk_at_end)),
      bows(start_bow + end_bow) {}

AccelerationPulse AccelerationPulse::over(const Slope& slope, double entry, double change) {
  const double rate = slope.rate;
  if (entry > rate) {
    AccelerationPulse pulse{entry, rate, (entry - rate) * slope.end_bow, 0.0, rate * slope.end_bow};
    pulse.hold_time = std::max(0.0, change - pulse.change()) * inverse(rate);
    return pulse;
  }
  const double reach =
      2.0 * change + entry * entry * slope.start_bow;  // = peak^2 bows + 2 peak hold
  const double without_hold = rate * rate * slope.bows;
  if (reach < without_hold) {
    return with_peak(slope, entry, std::clamp(std::sqrt(reach / slope.bows), entry, rate));
  }
  AccelerationPulse pulse = with_peak(slope, entry, rate);
  pulse.hold_time = 0.5 * (reach - without_hold) * inverse(rate);
  return pulse;
}

AccelerationPulse AccelerationPulse::with_peak(const Slope& slope, double entry, double peak) {
  return {entry, peak, (peak - entry) * slope.start_bow, 0.0, peak * slope.end_bow};
}

StoppingWay::StoppingWay(const Slope& slope)
    : rate_(slope.rate),
      half_inverse_rate_(0.5 * inverse(slope.rate)),
      inverse_bows_(inverse(slope.bows)),
      bow_slope_(slope.start_bow + 0.5 * slope.end_bow),
      cubic_(slope.bows * (2.0 * slope.start_bow + slope.end_bow) * (1.0 / 6.0)),
      held_from_(0.5 * rate_ * rate_ * slope.bows),
      held_linear_(0.5 * rate_ * slope.start_bow),
      held_constant_((1.0 / 24.0) * rate_ * rate_ * rate_ *
                     (slope.end_bow * slope.end_bow - slope.start_bow * slope.start_bow)) {}

double StoppingWay::operator()(double speed) const {
  return speed < held_from_ ? unlimited(speed) : held(speed);
}

ValueAndSlope StoppingWay::with_slope(double speed) const {
  if (speed < held_from_) {
    const double peak_squared = 2.0 * speed * inverse_bows_;
    const double peak = std::sqrt(peak_squared);
    return {cubic_ * peak_squared * peak, bow_slope_ * peak};
  }
  return {held(speed), 2.0 * speed * half_inverse_rate_ + held_linear_};
}

double StoppingWay::unlimited(double speed) const {
  const double peak_squared = 2.0 * speed * inverse_bows_;
  return cubic_ * peak_squared * std::sqrt(peak_squared);
}

double StoppingWay::peak_before(double length, double speed, const Slope& slope, double entry,
                                double highest) const {
  const auto excess = [&](double peak) {
    const double start_time = (peak - entry) * slope.start_bow;
    const double end_time = peak * slope.end_bow;
    const double at_peak = speed + 0.5 * (entry + peak) * start_time;
    const ValueAndSlope stopping = with_slope(at_peak + 0.5 * peak * end_time);
    const double way =
        start_time * (speed + start_time * ((1.0 / 3.0) * entry + (1.0 / 6.0) * peak)) +
        end_time * (at_peak + (1.0 / 3.0) * peak * end_time);
    const double growth =
        at_peak * slope.bows + peak * slope.start_bow * end_time + end_time * end_time;
    return ValueAndSlope{way + stopping.value - length,
                         growth + stopping.slope * peak * slope.bows};
  };
  // Over the entry the way grows at least as each of these powers does alone. The least that they
  // allow is near the peak, and is the peak for a start from rest if braking is not held.
  const ValueAndSlope at_entry = excess(entry);
  const double beyond = -at_entry.value;
  const double half = 0.5 * slope.bows;  // speed gained: half * peak^2
  const double gain_cubic = slope.bows * (slope.start_bow + 2.0 * slope.end_bow) * (1.0 / 6.0);
  const double cubic = gain_cubic + unlimited(half);
  double guess =
      std::min(cube_root(beyond / cubic), std::sqrt(std::sqrt(2.0 * rate_ * beyond) / half));
  if (speed > 0.0 || entry > 0.0) {
    const double square = 3.0 * gain_cubic * entry +
                          half * with_slope(speed + 0.5 * entry * entry * slope.end_bow).slope;
    guess = std::min({guess, std::sqrt(beyond / square), beyond / at_entry.slope});
  }
  return convex_root(entry, highest, entry + guess, way_tolerance(length), excess);
}

double StoppingWay::hold_before(double length, double speed, const AccelerationPulse& pulse,
                                double longest) const {
  const double peak = pulse.peak;
  const double least = speed + pulse.change();
  const double way = pulse.way(speed, 1.0) - length;
  const double linear = least + 0.5 * peak * pulse.end_time;  // growth of the way at first
  const auto excess = [&](double hold) {
    const ValueAndSlope stopping = with_slope(least + peak * hold);
    return ValueAndSlope{way + hold * (linear + 0.5 * peak * hold) + stopping.value,
                         linear + peak * (hold + stopping.slope)};
  };
  const auto parabola = [&](double constant, double braking_slope) {
    const double growth = linear + peak * braking_slope;
    const double curved = 0.5 * peak * (1.0 + peak / rate_);
    return -2.0 * constant / (growth + std::sqrt(growth * growth - 4.0 * curved * constant));
  };
  // Where braking is held, too, the way is a parabola over the time held.
  const double beyond = -excess(0.0).value;
  double guess = parabola(way + held(least), least / rate_ + held_linear_);
  if (!holds(least + peak * guess)) {  // or it lies above two curves
    const double root = cube_root(beyond / unlimited(peak));
    guess = std::min(root * root, parabola(-beyond, least / rate_));
  }
  return convex_root(0.0, longest, guess, way_tolerance(length), excess);
}

}  // namespace stator::control
