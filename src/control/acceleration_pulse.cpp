#include "control/acceleration_pulse.hpp"

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

}  // namespace stator::control
