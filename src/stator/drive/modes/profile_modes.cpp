#include "stator/drive/modes/profile_modes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "stator/drive/power/control_words.hpp"

namespace stator::drive {

namespace {

constexpr std::uint32_t kWindowOff = 0xFFFFFFFF;

/// Bits 1..0 of 60F2h: what a relative target is relative to.
enum class RelativeTo : std::uint16_t { preceding_target = 0, demand = 1, actual = 2 };

/// The standard's reading of target reached during halt: the motor stands.
std::uint16_t halted_status(const ModeContext& context) {
  return context.ready && context.motion.stands() ? statusword::kTargetReached : std::uint16_t{0};
}

}  // namespace

void ProfilePosition::enter(const ModeContext& context) {
  target_ = context.motion.position();
  direction_ = 0.0;
  commanded_ = false;
  acknowledged_ = false;
  in_window_ = false;
}

void ProfilePosition::travel(const ModeContext& context) {
  direction_ = target_ < context.motion.position() ? -1.0 : 1.0;
  target_ = context.motion.move_to(target_);
}

void ProfilePosition::halt(const ModeContext& context) {
  went_on_ = context.motion.goes_on();
  OperatingMode::halt(context);
}

/// A target that was passed with the end velocity, or while the motor came to rest from there, is
/// not gone back to.
void ProfilePosition::resume(const ModeContext& context) {
  const auto beyond = static_cast<double>(context.motion.position() - target_);
  const bool passes = context.settings.behaviour.end_velocity_goes_on &&
                      context.objects.end_velocity.get() != 0 && !context.motion.limited();
  if (commanded_ && (went_on_ || (passes && beyond * direction_ > 0.0))) {
    context.motion.go_on(direction_);
  } else if (commanded_) {
    travel(context);
  }
}

void ProfilePosition::on_controlword(const ModeContext& context, std::uint16_t previous,
                                     std::uint16_t present) {
  if ((present & controlword::kNewSetPoint) == 0) {
    acknowledged_ = false;
    return;
  }
  const bool edge = (previous & controlword::kNewSetPoint) == 0;
  if (!edge || !(context.enabled || context.halted)) {
    return;
  }
  target_ = new_target(context, (present & controlword::kRelative) != 0);
  commanded_ = true;
  acknowledged_ = true;
  in_window_ = false;
  went_on_ = false;
  direction_ = 0.0;  // known where the travel begins
  if (context.enabled) {
    travel(context);
  }
}

std::int64_t ProfilePosition::new_target(const ModeContext& context, bool relative) const {
  const std::int32_t object = context.objects.target_position.get();
  if (!relative) {
    return context.motion.absolute(object);
  }
  const std::int64_t way = context.motion.unscaled(object);
  switch (static_cast<RelativeTo>(context.objects.positioning_option.get() & 3U)) {
    case RelativeTo::demand:
      return context.motion.position() + way;
    case RelativeTo::actual:
      return context.actual_position() + way;
    case RelativeTo::preceding_target:
      break;
  }
  return target_ + way;
}

void ProfilePosition::tick(const ModeContext& context) {
  if (commanded_ && context.enabled) {
    target_ = context.motion.target();  // limits may have moved
  }
  const bool inside = within_window(context);
  if (inside && !in_window_) {
    window_entered_ = context.now;
  }
  in_window_ = inside;
}

bool ProfilePosition::within_window(const ModeContext& context) const {
  const std::int64_t deviation = context.motion.scaled(context.actual_position() - target_);
  const std::int64_t window = context.objects.position_window.get();
  return deviation <= window && deviation >= -window;
}

bool ProfilePosition::target_reached(const ModeContext& context) const {
  const std::uint32_t window = context.objects.position_window.get();
  if (window == kWindowOff && context.settings.position_end) {
    const PositionEnd& end = *context.settings.position_end;
    return commanded_ && std::llabs(context.actual_position() - target_) <= end.distance &&
           std::fabs(context.actual_velocity) <= end.velocity;
  }
  if (window == 0 || window == kWindowOff) {
    const std::int64_t distance = context.settings.position_end.value_or(PositionEnd{}).distance;
    return context.motion.stands() && context.motion.position() == target_ &&
           (!context.position_loop || std::llabs(context.actual_position() - target_) <= distance);
  }
  const base::SimDuration time(std::int64_t{context.objects.position_window_time.get()} *
                               1'000'000);
  return within_window(context) && in_window_ && context.now - window_entered_ >= time;
}

std::uint16_t ProfilePosition::status(const ModeContext& context) const {
  std::uint16_t bits = acknowledged_ ? statusword::kSetPointAcknowledge : std::uint16_t{0};
  if (context.halted) {
    bits |= halted_status(context);
  } else if (context.enabled && target_reached(context)) {
    bits |= statusword::kTargetReached;
  }
  return bits;
}

void ProfileVelocity::on_target(const ModeContext& context) {
  context.motion.move_at_velocity(
      context.settings.velocity_of(context.objects.target_velocity.get()));
}

void ProfileVelocity::tick(const ModeContext& context) {
  const bool inside = within_window(context);
  if (inside && !in_window_) {
    window_entered_ = context.now;
  }
  in_window_ = inside;
  const bool above = context.settings.velocity_threshold &&
                     std::fabs(context.actual_velocity) > *context.settings.velocity_threshold;
  if (above && !above_threshold_) {
    threshold_passed_ = context.now;
  }
  above_threshold_ = above;
  turns_ = above && context.now - threshold_passed_ >= context.settings.velocity_threshold_time;
}

bool ProfileVelocity::within_window(const ModeContext& context) const {
  const MotionUnits& units = context.settings.units;
  const double wanted = context.settings.velocity_of(context.objects.target_velocity.get());
  const double target = std::clamp(wanted, -units.maximum_velocity(), units.maximum_velocity());
  return context.motion.velocity() == target &&
         std::fabs(context.actual_velocity - target) <= context.settings.velocity_window;
}

std::uint16_t ProfileVelocity::status(const ModeContext& context) const {
  const std::uint16_t speed =
      context.settings.velocity_threshold && !turns_ ? statusword::kSpeedZero : std::uint16_t{0};
  if (context.halted) {
    return static_cast<std::uint16_t>(halted_status(context) | speed);
  }
  const base::SimDuration time = context.settings.velocity_window_time;
  const bool reached =
      within_window(context) &&
      (time == base::SimDuration(0) || (in_window_ && context.now - window_entered_ >= time));
  return static_cast<std::uint16_t>((context.enabled && reached ? statusword::kTargetReached : 0U) |
                                    speed);
}

}  // namespace stator::drive
