#include "stator/drive/modes/homing_mode.hpp"

#include <cmath>
#include <cstdlib>

#include "stator/drive/power/control_words.hpp"

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
constexpr EventRule kNoAcceleration{"homing-no-acceleration", Severity::refusal,
                                    "axis {0}: homing method {1} not started: 609Ah is 0; a method "
                                    "that moves needs an acceleration "
                                    "above 0"};
// {1} 6098h.
constexpr EventRule kNoMethod{"homing-no-method", Severity::refusal,
                              "axis {0}: homing not started: 6098h is {1}, which is no method to "
                              "run; write one of those that "
                              "60E3h lists"};
constexpr EventRule kBlocked{
    "homing-blocked", Severity::warning,
    "axis {0}: homing method {1} ended with a homing error: a limit switch that the method does "
    "not "
    "use is in the way; look for the method's switch, or start from its other side"};
constexpr EventRule kNotFound{
    "homing-not-found", Severity::warning,
    "axis {0}: homing method {1} ended with a homing error: both limit switches were met and the "
    "home switch was not; look at the home switch, its wiring and its polarity"};

}  // namespace

void Homing::enter(const ModeContext& context) {
  if (runs()) {
    interrupt(context);
  } else if (outcome_ == Outcome::failed) {
    outcome_ = Outcome::none;
  }
  stage_ = Stage::waiting;
}

void Homing::start(const ModeContext& context) {
  const std::uint16_t controlword = context.objects.controlword.get();
  on_controlword(context, controlword, controlword);
}

void Homing::resume(const ModeContext& context) {
  if (!runs()) {
    start(context);
  }
}

void Homing::on_controlword(const ModeContext& context, std::uint16_t previous,
                            std::uint16_t present) {
  if ((present & controlword::kHomingStart) != 0) {
    const bool edge = (previous & controlword::kHomingStart) == 0;
    if (stage_ == Stage::waiting && (edge || !context.settings.behaviour.homing_starts_on_edge)) {
      begin(context);
    }
    return;
  }
  if (runs()) {
    interrupt(context);
    if (context.enabled) {  // otherwise the power state machine or halt brakes already
      context.motion.brake(Braking::slow_down_ramp);
    }
  }
  stage_ = Stage::waiting;
}

void Homing::begin(const ModeContext& context) {
  outcome_ = Outcome::none;
  context.capture.disarm();
  method_ = find_homing_method(context.objects.homing_method.get());
  const bool moves = method_ != nullptr && method_->signal != HomeSignal::present_position;
  if (moves && !context.enabled && !context.halted) {
    return;
  }
  if (const EventRule* rule = obstacle(context); rule != nullptr) {
    explain(context, *rule);
    if (context.settings.behaviour.homing_by_profile) {
      outcome_ = Outcome::failed;
      stage_ = Stage::done;
    }
    return;
  }
  if (method_ == nullptr) {
    return;
  }
  outcome_ = Outcome::running;
  limits_met_ = 0;
  direction_ = method_->search_direction;
  switch (method_->signal) {
    case HomeSignal::present_position:
      stage_ = Stage::naming;
      break;
    case HomeSignal::hard_stop:
      stage_ = Stage::pushing;
      hard_stop_.begin(*method_);
      break;
    case HomeSignal::index:
      stage_ = Stage::indexing;
      break;
    case HomeSignal::release:
    case HomeSignal::release_and_index:
      stage_ = Stage::searching;
      break;
  }
  context.motion.set_position_scale(1.0);
  if (stage_ != Stage::pushing) {
    tick(context);
  }
}

const EventRule* Homing::obstacle(const ModeContext& context) const {
  if (method_ == nullptr) {
    return context.settings.behaviour.homing_by_profile ? &kNoMethod : nullptr;
  }
  if (method_->signal == HomeSignal::present_position) {
    return nullptr;
  }
  const bool on_hard_stop = method_->signal == HomeSignal::hard_stop;
  const bool has_speeds =
      homing_slow_speed(context) > 0.0 && (on_hard_stop || homing_fast_speed(context) > 0.0);
  const bool needs_speeds = context.settings.behaviour.homing_needs_speeds;
  if (!has_speeds && (on_hard_stop || needs_speeds)) {
    return &kNoSpeed;
  }
  if (needs_speeds && context.objects.homing_acceleration.get() == 0) {
    return &kNoAcceleration;
  }
  if (on_hard_stop && context.settings.hard_stop.current <= 0.0) {
    return &kNoThreshold;
  }
  return nullptr;
}

void Homing::explain(const ModeContext& context, const EventRule& rule) const {
  context.reporter.report(
      context.now, rule,
      {EventArgument(int{context.axis}), EventArgument(int{context.objects.homing_method.get()}),
       EventArgument(std::int64_t{context.objects.homing_fast_speed.get()}),
       EventArgument(std::int64_t{context.objects.homing_slow_speed.get()}),
       EventArgument(static_cast<std::int64_t>(context.settings.hard_stop.current * 1e3))});
}

void Homing::interrupt(const ModeContext& context) {
  context.capture.disarm();
  stage_ = Stage::waiting;
  outcome_ = Outcome::interrupted;
}

void Homing::fail(const ModeContext& context, const EventRule& rule) {
  explain(context, rule);
  context.capture.disarm();
  if (context.enabled) {
    context.motion.brake(Braking::slow_down_ramp);
  }
  stage_ = Stage::done;
  outcome_ = Outcome::failed;
}

void Homing::tick(const ModeContext& context) {
  if (!runs()) {
    return;
  }
  if (stage_ == Stage::naming) {
    if (context.motion.stands()) {
      name_present_position(context);
    }
    return;
  }
  if (!context.enabled && !context.halted) {
    interrupt(context);
    return;
  }
  if (stage_ == Stage::pushing) {
    if (context.enabled && hard_stop_.advance(context)) {
      attain();
    }
    return;
  }
  look(context);
  if (!runs() || !context.enabled) {
    return;
  }
  command_motion(context);
  if (stage_ == Stage::returning && is_home(context)) {
    finish(context);
  }
}

/// What the switches tell, also while halt brakes: an edge that is passed then counts or is
/// searched again, as it would without halt.
void Homing::look(const ModeContext& context) {
  if (stage_ == Stage::searching) {
    search(context);
  }
  if (stage_ == Stage::leaving) {
    leave(context);
  }
  if (stage_ == Stage::indexing || stage_ == Stage::leaving) {
    await_capture(context);
  }
}

void Homing::name_present_position(const ModeContext& context) {
  const bool by_profile = context.settings.behaviour.homing_by_profile;
  const std::int64_t position = by_profile ? home_position(context) : 0;
  context.motion.set_position(position);
  context.feedback.set_position(position);
  attain();
}

void Homing::search(const ModeContext& context) {
  if (pressed(context)) {
    stage_ = Stage::leaving;
    direction_ = -method_->search_direction;
    was_pressed_ = true;
  } else if (method_->reverses_at_limit_switch && limit_reached(context)) {
    ++limits_met_;
    if (limits_met_ > 1 && context.settings.behaviour.homing_by_profile) {
      fail(context, kNotFound);
      return;
    }
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

PassedSwitches Homing::passed_switches() const {
  const bool passes_both = stage_ == Stage::searching && method_->reverses_at_limit_switch;
  const bool uses_switch = method_->signal != HomeSignal::index;
  const auto passes = [&](ReferenceSwitch limit) {
    return passes_both || (uses_switch && method_->reference == limit);
  };
  return {.negative_limit = passes(ReferenceSwitch::negative_limit),
          .positive_limit = passes(ReferenceSwitch::positive_limit)};
}

void Homing::command_motion(const ModeContext& context) {
  const PassedSwitches passed = passed_switches();
  const std::int64_t way = stage_ == Stage::returning
                               ? captured_position(context) - context.motion.position()
                               : direction_;
  const AxisConditions& limits = context.conditions;
  const bool blocked = (way > 0 && limits.positive_limit_switch && !passed.positive_limit) ||
                       (way < 0 && limits.negative_limit_switch && !passed.negative_limit);
  if (blocked && context.settings.behaviour.homing_by_profile) {
    fail(context, kBlocked);
    return;
  }
  if (stage_ == Stage::returning) {
    context.motion.search_to(captured_position(context), homing_slow_speed(context), passed);
    return;
  }
  const double speed =
      stage_ == Stage::searching ? homing_fast_speed(context) : homing_slow_speed(context);
  context.motion.search_at_velocity(direction_ * speed, passed);
}

/// The demand rests on the point held, and the shaft of a servo axis is there.
bool Homing::is_home(const ModeContext& context) const {
  const std::int64_t home = captured_position(context);
  return context.motion.at_rest() && context.motion.position() == home &&
         shaft_is_at(context, home);
}

/// Of the point at which home is.
std::int64_t Homing::home_position(const ModeContext& context) {
  const std::int64_t offset = context.objects.home_offset.get();
  return context.settings.reference.home_offset_is_position ? offset : -offset;
}

void Homing::finish(const ModeContext& context) {
  const std::int64_t home = home_position(context);
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

/// pps: of the shaft of a servo axis, 0 where it stands; of the ramp of a stepper.
double Homing::velocity(const ModeContext& context) const {
  return context.position_loop ? context.motion.shaft_velocity() : context.motion.velocity();
}

bool Homing::travels_forward(const ModeContext& context) const {
  return velocity(context) * direction_ > 0.0;
}

/// Both what is asked for and what the shaft makes of it, which may exceed it a little.
bool Homing::slow_enough(const ModeContext& context) const {
  constexpr double kExcess = 1.5;
  const double slow = homing_slow_speed(context);
  const double demand = context.motion.velocity() * direction_;
  const double shaft = velocity(context) * direction_;
  return demand >= 0.0 && demand <= slow && shaft >= 0.0 && shaft <= kExcess * slow;
}

/// The point held, in the position's present coordinates.
std::int64_t Homing::captured_position(const ModeContext& context) const {
  return context.position_of(*context.capture.captured());
}

std::uint16_t Homing::status(const ModeContext& context) const {
  const bool by_profile = context.settings.behaviour.homing_by_profile;
  const std::uint16_t standing =
      context.motion.stands() ? statusword::kTargetReached : std::uint16_t{0};
  switch (outcome_) {
    case Outcome::attained:
      return statusword::kTargetReached | statusword::kHomeAttained;
    case Outcome::interrupted:
      return standing;
    case Outcome::failed:
      return static_cast<std::uint16_t>(statusword::kHomingError | standing);
    case Outcome::none:
      return by_profile ? standing : std::uint16_t{0};
    case Outcome::running:
      return context.halted && context.ready ? standing : std::uint16_t{0};
  }
  return 0;
}

}  // namespace stator::drive
