#include "stator/drive/modes/hard_stop_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace stator::drive {

namespace {

/// For which a shaft that has not run yet stands against a stop.
constexpr base::SimDuration kStallTime{100'000'000};

constexpr PassedSwitches kAllPassed{.negative_limit = true, .positive_limit = true};

/// 6099h:02, not above 6099h:01 if that is set.
double search_speed(const ModeContext& context) {
  const double fast = homing_fast_speed(context);
  const double slow = homing_slow_speed(context);
  return fast > 0.0 ? std::min(slow, fast) : slow;
}

double return_speed(const ModeContext& context) {
  const double fast = homing_fast_speed(context);
  return fast > 0.0 ? fast : homing_slow_speed(context);
}

}  // namespace

double homing_fast_speed(const ModeContext& context) {
  return context.settings.units.velocity(context.objects.homing_fast_speed.get());
}

double homing_slow_speed(const ModeContext& context) {
  return context.settings.units.velocity(context.objects.homing_slow_speed.get());
}

void HardStopSearch::begin(const HomingMethod& method) {
  method_ = &method;
  stage_ = Stage::pushing;
  direction_ = method.search_direction;
  second_ = false;
}

bool HardStopSearch::advance(const ModeContext& context) {
  if (stage_ == Stage::pushing) {
    push(context);
    return false;
  }
  context.motion.search_to(goal_, return_speed(context), kAllPassed);
  return is_on_goal(context) && arrived(context);
}

bool HardStopSearch::is_on_goal(const ModeContext& context) const {
  return context.motion.at_rest() && context.motion.position() == goal_ &&
         shaft_is_at(context, goal_);
}

bool shaft_is_at(const ModeContext& context, std::int64_t goal) {
  if (!context.position_loop) {
    return true;
  }
  const PositionEnd end = context.settings.position_end.value_or(PositionEnd{});
  return std::llabs(context.actual_position() - goal) <= end.distance &&
         std::fabs(context.actual_velocity) <= end.velocity;
}

void HardStopSearch::push(const ModeContext& context) {
  const double velocity = direction_ * search_speed(context);
  context.motion.push_at_velocity(velocity, kAllPassed);
  if (!held_up(context, velocity)) {
    return;
  }
  context.motion.rest_at_shaft();
  const HardStopSettings& settings = context.settings.hard_stop;
  goal_ = context.motion.position() -
          direction_ * (direction_ > 0 ? settings.positive_clearance : settings.negative_clearance);
  stage_ = Stage::returning;
}

/// Friction and a load that has to gain speed take current as well: a shaft that has run, with half
/// the current of a stop, is held up as soon as its current reaches that of a stop; one that has
/// not, when it stands with that current for kStallTime.
bool HardStopSearch::held_up(const ModeContext& context, double velocity) {
  const double stop_current = context.settings.hard_stop.current;
  const double current = context.motor_current * direction_;
  const double shaft = context.motion.shaft_velocity() * direction_;
  if (context.motion.velocity() != velocity) {  // at the start, and after halt
    has_run_ = false;
    is_stalled_ = false;
    return false;
  }
  if (shaft >= 0.5 * std::fabs(velocity) && current <= 0.5 * stop_current) {
    has_run_ = true;
  }
  const bool presses = current >= stop_current;
  const bool stalled = presses && shaft == 0.0;
  if (stalled && !is_stalled_) {
    stalled_since_ = context.now;
  }
  is_stalled_ = stalled;
  return presses && (has_run_ || (stalled && context.now - stalled_since_ >= kStallTime));
}

bool HardStopSearch::arrived(const ModeContext& context) {
  if (second_) {
    const std::int64_t end = context.actual_position();
    set_limit(context, end);
    if (method_->scales) {
      scale(context, end);
    }
    return true;
  }
  context.motion.set_position(0);
  context.feedback.set_position(0);
  set_limit(context, 0);
  if (!method_->both_ends) {
    return true;
  }
  second_ = true;
  direction_ = -direction_;
  stage_ = Stage::pushing;
  return false;
}

void HardStopSearch::set_limit(const ModeContext& context, std::int64_t position) const {
  dictionary::Variable<std::int32_t> limit =
      direction_ > 0 ? context.objects.maximum_position : context.objects.minimum_position;
  limit.set(static_cast<std::int32_t>(position));
}

void HardStopSearch::scale(const ModeContext& context, std::int64_t end) const {
  if (end == 0) {
    return;
  }
  context.motion.set_position_scale(kScaledRange / static_cast<double>(std::llabs(end)));
  set_limit(context, context.motion.scaled(end));
}

}  // namespace stator::drive
