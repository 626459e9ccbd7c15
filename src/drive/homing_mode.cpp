#include "drive/homing_mode.hpp"

#include "drive/control_words.hpp"

namespace stator::drive {

namespace {

using base::EventArgument;
using base::EventRule;
using base::Severity;

// {0} axis, {1} homing method, {2} and {3} the speeds, {4} the threshold in mA.
constexpr EventRule kNoSpeed{
    "homing-no-speed", Severity::refusal,
    "axis {0}: homing method {1} not started: 6099h is {2} and {3} rpm; a method that moves needs "
    "speeds above 0 (a hard stop is searched with 6099h:02 alone)"};
constexpr EventRule kNoThreshold{
    "homing-no-current-threshold", Severity::refusal,
    "axis {0}: homing method {1} not started: the current that tells a hard stop is {4} mA; write "
    "one above that of the friction and below the torque limit"};

}  // namespace

void Homing::enter(const ModeContext& context) {
  if (runs()) {
    interrupt(context);
  }
  stage_ = Stage::waiting;
}

void Homing::start(const ModeContext& context) {
  const std::uint16_t controlword = context.objects.controlword.get();
  on_controlword(context, controlword, controlword);
}

void Homing::on_controlword(const ModeContext& context, std::uint16_t /*previous*/,
                            std::uint16_t present) {
  if ((present & controlword::kHomingStart) != 0) {
    if (stage_ == Stage::waiting) {
      begin(context);
    }
    return;
  }
  if (runs()) {
    interrupt(context);
    if (context.enabled) {  // otherwise the power state machine brakes already
      context.motion.brake(Braking::slow_down_ramp);
    }
  }
  stage_ = Stage::waiting;
}

void Homing::begin(const ModeContext& context) {
  method_ = find_homing_method(context.objects.homing_method.get());
  if (method_ == nullptr) {
    return;
  }
  if (method_->signal == HomeSignal::present_position) {
    context.motion.set_position_scale(1.0);
    context.motion.set_position(0);
    context.feedback.set_position(0);
    attain();
    return;
  }
  outcome_ = Outcome::none;
  if (!context.enabled || !may_start(context)) {
    return;
  }
  context.motion.set_position_scale(1.0);
  outcome_ = Outcome::running;
  if (method_->signal == HomeSignal::hard_stop) {
    stage_ = Stage::pushing;
    hard_stop_.begin(*method_);
    return;
  }
  direction_ = method_->search_direction;
  context.capture.disarm();
  stage_ = method_->signal == HomeSignal::index ? Stage::indexing : Stage::searching;
  tick(context);
}

bool Homing::may_start(const ModeContext& context) const {
  const bool on_hard_stop = method_->signal == HomeSignal::hard_stop;
  const bool has_speeds =
      homing_slow_speed(context) > 0.0 && (on_hard_stop || homing_fast_speed(context) > 0.0);
  const auto explain = [&](const EventRule& rule) {
    context.reporter.report(
        context.now, rule,
        {EventArgument(int{context.axis}), EventArgument(int{method_->code}),
         EventArgument(std::int64_t{context.objects.homing_fast_speed.get()}),
         EventArgument(std::int64_t{context.objects.homing_slow_speed.get()}),
         EventArgument(static_cast<std::int64_t>(context.settings.hard_stop.current * 1e3))});
  };
  if (!has_speeds && (on_hard_stop || context.settings.behaviour.homing_needs_speeds)) {
    explain(kNoSpeed);
    return false;
  }
  if (on_hard_stop && context.settings.hard_stop.current <= 0.0) {
    explain(kNoThreshold);
    return false;
  }
  return true;
}

void Homing::interrupt(const ModeContext& context) {
  context.capture.disarm();
  stage_ = Stage::waiting;
  outcome_ = Outcome::interrupted;
}

void Homing::tick(const ModeContext& context) {
  if (!runs()) {
    return;
  }
  if (!context.enabled) {
    interrupt(context);
    return;
  }
  if (stage_ == Stage::pushing) {
    if (hard_stop_.advance(context)) {
      attain();
    }
    return;
  }
  if (stage_ == Stage::searching) {
    search(context);
  }
  if (stage_ == Stage::leaving) {
    leave(context);
  }
  if (stage_ == Stage::indexing || stage_ == Stage::leaving) {
    await_capture(context);
  }
  command_motion(context);
  if (stage_ == Stage::returning && context.motion.at_rest() &&
      context.motion.position() == captured_position(context)) {
    finish(context);
  }
}

void Homing::search(const ModeContext& context) {
  if (pressed(context)) {
    stage_ = Stage::leaving;
    direction_ = -method_->search_direction;
    was_pressed_ = true;
  } else if (method_->reverses_at_limit_switch && limit_reached(context)) {
    direction_ = -direction_;
  }
}

void Homing::leave(const ModeContext& context) {
  if (context.capture.armed() || context.capture.captured()) {
    return;
  }
  const bool was_pressed = was_pressed_;
  was_pressed_ = pressed(context);
  const bool released = was_pressed && !was_pressed_;
  if (released && travels_forward(context)) {
    // Met coming from the far side and passed before the motor was slow.
    stage_ = Stage::searching;
    direction_ = -direction_;
  } else if (slow_enough(context)) {
    context.capture.arm_release(method_->reference,
                                method_->signal == HomeSignal::release_and_index);
  }
}

void Homing::await_capture(const ModeContext& context) {
  if (context.capture.captured()) {
    stage_ = Stage::returning;
  } else if (stage_ == Stage::indexing && !context.capture.armed() && slow_enough(context)) {
    context.capture.arm_index();
  }
}

void Homing::command_motion(const ModeContext& context) const {
  const bool passes_both = stage_ == Stage::searching && method_->reverses_at_limit_switch;
  const bool uses_switch = method_->signal != HomeSignal::index;
  const auto passes = [&](ReferenceSwitch limit) {
    return passes_both || (uses_switch && method_->reference == limit);
  };
  const PassedSwitches passed{.negative_limit = passes(ReferenceSwitch::negative_limit),
                              .positive_limit = passes(ReferenceSwitch::positive_limit)};
  if (stage_ == Stage::returning) {
    context.motion.search_to(captured_position(context), homing_slow_speed(context), passed);
    return;
  }
  const double speed =
      stage_ == Stage::searching ? homing_fast_speed(context) : homing_slow_speed(context);
  context.motion.search_at_velocity(direction_ * speed, passed);
}

void Homing::finish(const ModeContext& context) {
  const std::int64_t offset = context.objects.home_offset.get();
  const std::int64_t home = context.settings.reference.home_offset_is_position ? offset : -offset;
  context.motion.set_position(home);
  context.feedback.set_position_at(context.capture.captured()->encoder_count, home);
  attain();
}

void Homing::attain() {
  stage_ = Stage::done;
  outcome_ = Outcome::attained;
  ++completions_;
}

bool Homing::pressed(const ModeContext& context) const {
  return context.conditions.switches().of(method_->reference);
}

bool Homing::limit_reached(const ModeContext& context) const {
  return direction_ > 0 ? context.conditions.positive_limit_switch
                        : context.conditions.negative_limit_switch;
}

bool Homing::travels_forward(const ModeContext& context) const {
  return context.motion.velocity() * direction_ > 0.0;
}

bool Homing::slow_enough(const ModeContext& context) const {
  const double velocity = context.motion.velocity() * direction_;
  return velocity >= 0.0 && velocity <= homing_slow_speed(context);
}

/// The point held, in the position's present coordinates.
std::int64_t Homing::captured_position(const ModeContext& context) const {
  return context.position_of(*context.capture.captured());
}

std::uint16_t Homing::status(const ModeContext& context) const {
  switch (outcome_) {
    case Outcome::attained:
      return statusword::kTargetReached | statusword::kHomeAttained;
    case Outcome::interrupted:
      return context.motion.at_rest() ? statusword::kTargetReached : std::uint16_t{0};
    case Outcome::none:
    case Outcome::running:
      break;
  }
  return 0;
}

}  // namespace stator::drive
