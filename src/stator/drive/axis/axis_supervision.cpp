// What every axis watches: following error and limits; and what its errors lead to.

#include <array>
#include <cstdlib>

#include "stator/drive/axis/axis.hpp"

namespace stator::drive {

namespace {

using base::EventArgument;
using base::EventRule;
using base::Severity;

// {0} axis, {1} actual position, {2} demand or limit.
constexpr std::array<EventRule, kAxisErrorCount> kErrorRules{{
    {"axis-following-error", Severity::fault,
     "axis {0}: following error: actual position {1}, demand {2}, further apart than 6065h allows; "
     "look for a blocked shaft or a velocity the motor cannot reach, then reset the fault"},
    {"axis-positive-software-limit", Severity::warning,
     "axis {0}: actual position {1} is beyond the positive software limit {2}; move back"},
    {"axis-negative-software-limit", Severity::warning,
     "axis {0}: actual position {1} is beyond the negative software limit {2}; move back"},
    {"axis-positive-limit-switch", Severity::warning,
     "axis {0}: positive limit switch touched at position {1}; motion is possible in negative "
     "direction only, or with the switch deactivated"},
    {"axis-negative-limit-switch", Severity::warning,
     "axis {0}: negative limit switch touched at position {1}; motion is possible in positive "
     "direction only, or with the switch deactivated"},
    {"axis-stall", Severity::warning,
     "axis {0}: stopped at position {1}: the load measurement fell to 0 above the speed of the "
     "stop on stall; look for a blocked shaft, or raise current or stall threshold, then move "
     "again"},
    {"axis-open-load-a", Severity::warning,
     "axis {0}: no current flows in phase A; look for a broken motor cable"},
    {"axis-open-load-b", Severity::warning,
     "axis {0}: no current flows in phase B; look for a broken motor cable"},
    {"axis-overcurrent-a", Severity::fault,
     "axis {0}: overcurrent in bridge A, the driver is switched off; look for a short in motor or "
     "cable, then reset the fault"},
    {"axis-overcurrent-b", Severity::fault,
     "axis {0}: overcurrent in bridge B, the driver is switched off; look for a short in motor or "
     "cable, then reset the fault"},
    {"axis-overcurrent-high-side", Severity::fault,
     "axis {0}: overcurrent on the high side, the driver is switched off; look for a short in the "
     "driver stage, then reset the fault"},
    {"axis-over-temperature-warning", Severity::warning,
     "axis {0}: the driver is near its temperature limit; lower the current or cool the module"},
    {"axis-over-temperature", Severity::fault,
     "axis {0}: the driver is too hot and has been switched off; let it cool, then reset the "
     "fault"},
    {"axis-undervoltage", Severity::fault,
     "axis {0}: the supply is too low to drive a motor; restore it, then reset the fault"},
    {"axis-shutdown-switch", Severity::fault,
     "axis {0}: the shutdown switch is active, the driver is switched off; release it, then reset "
     "the fault"},
    {"axis-overcurrent-c", Severity::fault,
     "axis {0}: overcurrent in bridge C, the driver is switched off; look for a short in motor or "
     "cable, then reset the fault"},
    {"axis-overvoltage", Severity::fault,
     "axis {0}: the supply is too high, the driver is switched off and the motor coasts; lower the "
     "supply, brake on a gentler ramp, or let a brake chopper take what the motor feeds back, then "
     "reset the fault"},
    {"axis-hall-error", Severity::fault,
     "axis {0}: the hall sensors show a state or a sequence that does not exist; look for a broken "
     "wire, check their order and polarity, then reset the fault"},
    {"axis-initialisation-error", Severity::fault,
     "axis {0}: the commutation angle of the encoder was not found; check initialisation mode, "
     "current and encoder, then reset the fault and enable again"},
    {"axis-driver-error", Severity::fault,
     "axis {0}: the gate driver reports a fault and has been switched off; reset the fault"},
    {"axis-overload", Severity::warning,
     "axis {0}: the I2t sum is above its limit, the motor gets no current until it has cooled down "
     "and the flag is cleared; lower the load, or check time constant and limit"},
}};

}  // namespace

void Axis::supervise(base::SimTime now) {
  const std::int64_t actual = actual_position();
  watch(AxisError::following_error, following_error(actual - motion_.position(), now), now);

  const bool homes = mode_->code() == ModeCode::homing;  // no limit means anything yet
  const auto upper = motion_.upper_limit();
  const auto lower = motion_.lower_limit();
  // A shaft that rests on its target on a limit swings a count or two about it.
  const std::int64_t margin = settings_.position_end.value_or(PositionEnd{}).distance;
  const auto beyond = [&](AxisError error, std::int64_t way) {
    return !homes && way > (causes_.has(error) ? 0 : margin);
  };
  watch(AxisError::positive_software_limit,
        upper && beyond(AxisError::positive_software_limit, actual - *upper), now);
  watch(AxisError::negative_software_limit,
        lower && beyond(AxisError::negative_software_limit, *lower - actual), now);
  watch(AxisError::positive_limit_switch, conditions_.positive_limit_switch && !homes, now);
  watch(AxisError::negative_limit_switch, conditions_.negative_limit_switch && !homes, now);
  supervise_stage(now);
}

bool Axis::following_error(std::int64_t deviation, base::SimTime now) {
  const std::int64_t window = objects_.following_window.get();
  const bool outside = power_.bridge_enabled() && objects_.uses_encoder() && window > 0 &&
                       !motion_.torque() && std::abs(deviation) > window;
  if (outside && !follows_badly_) {
    follows_badly_since_ = now;
  }
  follows_badly_ = outside;
  const base::SimDuration time_out(std::int64_t{objects_.following_time_out.get()} * 1'000'000);
  return outside && now - follows_badly_since_ >= time_out;
}

bool Axis::stall_blocks() const {
  // A master that goes on sending cyclic targets must not drive the motor into the obstacle again.
  return stalled_ && (mode_ == &cyclic_position_ || mode_ == &cyclic_velocity_);
}

void Axis::take_up(AxisError error, bool present, base::SimTime now) {
  const bool appears = present && !causes_.has(error);
  causes_.set(error, present);
  if (!present && !is_fault(error)) {
    errors_.set(error, false);
  }
  if (!appears || errors_.has(error)) {
    return;
  }
  errors_.set(error, true);
  const std::int64_t reference =
      error == AxisError::positive_software_limit   ? motion_.upper_limit().value_or(0)
      : error == AxisError::negative_software_limit ? motion_.lower_limit().value_or(0)
                                                    : motion_.position();
  reporter_.report(now, kErrorRules[static_cast<std::size_t>(error)],
                   {EventArgument(int{configuration_.number}), EventArgument(actual_position()),
                    EventArgument(reference)});
  if (is_fault(error)) {
    power_.raise_fault(power_input(now), reaction_to(error) == ErrorReaction::power_off);
  }
}

ErrorReaction Axis::reaction_to(AxisError error) const {
  return configuration_.reactions[static_cast<std::size_t>(error)];
}

bool Axis::is_fault(AxisError error) const {
  return reaction_to(error) == ErrorReaction::fault ||
         reaction_to(error) == ErrorReaction::power_off;
}

bool Axis::fault_present() const {
  return causes_.any_of(fault_errors_);
}

bool Axis::warning_present() const {
  return causes_.any_of(warning_errors_);
}

}  // namespace stator::drive
