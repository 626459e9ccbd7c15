#include "stator/control/ramp/ramp_generator.hpp"

#include <algorithm>
#include <cmath>

#include "stator/control/ramp/ramp_profile.hpp"

namespace stator::control {

namespace {

/// What an s-shaped ramp takes over: an acceleration that was going to end in a step, which those
/// of linear ramps and of the cyclic modes do, ends now.
MotionState smooth(const MotionState& now, double end_jerk) {
  return {now.position, now.velocity, end_jerk > 0.0 ? now.acceleration : 0.0};
}

}  // namespace

RampGenerator::RampGenerator() {
  MotionPlan plan;
  plan.rest({});
  play(plan);
}

void RampGenerator::move_to(std::int64_t target, const RampLimits& limits) {
  if (state_.mode == RampMode::position && state_.target_position == target &&
      state_.limits == limits) {
    return;
  }
  state_.mode = RampMode::position;
  state_.target_position = target;
  state_.limits = limits;
  replan();
}

void RampGenerator::move_at_velocity(double velocity, const RampLimits& limits) {
  if (state_.mode == RampMode::velocity && state_.target_velocity == velocity &&
      state_.limits == limits) {
    return;
  }
  state_.mode = RampMode::velocity;
  state_.target_velocity = velocity;
  state_.limits = limits;
  replan();
}

void RampGenerator::set_limits(const RampLimits& limits) {
  if (state_.limits == limits) {
    return;
  }
  state_.limits = limits;
  replan();
}

void RampGenerator::follow_position(std::int64_t target, base::SimDuration period) {
  state_.mode = RampMode::follow_position;
  state_.target_position = target;
  play(plan_position_interpolation(state_.now, target, period));
}

void RampGenerator::follow_velocity(double velocity, base::SimDuration period) {
  state_.mode = RampMode::follow_velocity;
  state_.target_velocity = velocity;
  play(plan_velocity_interpolation(state_.now, velocity, period));
}

void RampGenerator::stop(double deceleration) {
  state_.mode = RampMode::stop;
  play(six_point::stop(begin_of_ramp(), deceleration));
}

void RampGenerator::stop(const RampLimits& limits) {
  state_.mode = RampMode::stop;
  const double jerk = end_jerk();
  play(plan_stop(smooth(begin_of_ramp(), jerk), limits, jerk));
}

void RampGenerator::set_position(std::int64_t microsteps) {
  state_.origin += state_.now.position.microsteps - microsteps;
  state_.now.position.microsteps = microsteps;
  stop_at_once();
}

void RampGenerator::shift(std::int64_t microsteps) {
  if (microsteps == 0) {
    return;
  }
  state_.origin -= microsteps;
  state_.target_position += microsteps;
  state_.now.position.microsteps += microsteps;
  state_.playing.reference_position.microsteps += microsteps;
  for (std::size_t i = 0; i < state_.plan.size(); ++i) {
    state_.plan[i].reference_position.microsteps += microsteps;
  }
}

double RampGenerator::end_jerk() const {
  const double acceleration = state_.now.acceleration;
  for (std::size_t i = state_.segment; i + 1 < state_.plan.size(); ++i) {
    const double jerk = state_.plan[i].jerk;
    if (jerk * acceleration < 0.0) {
      return std::fabs(jerk);
    }
    if (state_.plan[i + 1].at(0.0).acceleration * acceleration <= 0.0) {
      break;
    }
  }
  return 0.0;
}

MotionState RampGenerator::begin_of_ramp() const {
  MotionState begin = state_.now;
  begin.velocity = std::clamp(begin.velocity, -state_.maximum_velocity, state_.maximum_velocity);
  return begin;
}

void RampGenerator::replan() {
  const double jerk = end_jerk();
  const MotionState start = smooth(begin_of_ramp(), jerk);
  if (state_.mode == RampMode::position) {
    play(plan_positioning(start, state_.target_position, state_.limits, jerk));
  } else if (state_.mode == RampMode::velocity) {
    play(plan_velocity(start, state_.target_velocity, state_.limits, jerk));
  }
}

void RampGenerator::play(const MotionPlan& plan) {
  state_.plan = plan;
  enter(0, 0.0);
  state_.now = plan[0].at(0.0);
}

/// Plays `segment`, which began `lead` seconds before the present tick.
void RampGenerator::enter(std::size_t segment, double lead) {
  state_.segment = segment;
  state_.playing = state_.plan[segment];
  state_.playing.duration -= lead;
  state_.playing.reference_time -= lead;
  state_.segment_elapsed = base::SimDuration(0);
}

/// Enters the segment in force `time` seconds after the tick in which the present one was entered.
void RampGenerator::leave_segment(double time) {
  const std::size_t last = state_.plan.size() - 1;
  if (state_.segment < last) {
    time -= state_.playing.duration;
    std::size_t next = state_.segment + 1;
    while (next < last && time > state_.plan[next].duration) {
      time -= state_.plan[next].duration;
      ++next;
    }
    enter(next, time);
    time = 0.0;
  }
  if (time > state_.playing.duration) {
    state_.plan[last].reference_position = state_.playing.at(time).position;
    enter(last, 0.0);
  }
}

bool RampGenerator::at_rest() const {
  return state_.now.velocity == 0.0 &&
         (phase() == RampPhase::standstill || remaining_time() <= 0.0);
}

bool RampGenerator::target_reached() const {
  switch (state_.mode) {
    case RampMode::position:
    case RampMode::follow_position:
      return state_.now.position == MicrostepPosition{state_.target_position, 0.0} &&
             (state_.mode == RampMode::follow_position || at_rest());
    case RampMode::velocity:
    case RampMode::follow_velocity:
      return state_.now.velocity == state_.target_velocity;
    case RampMode::stop:
      break;
  }
  return at_rest();
}

double RampGenerator::braking_distance(const RampLimits& limits) const {
  const double jerk = end_jerk();
  return control::braking_distance(smooth(begin_of_ramp(), jerk), limits, jerk);
}

double RampGenerator::remaining_time() const {
  if (state_.segment + 1 == state_.plan.size()) {
    return 0.0;
  }
  double sum = state_.playing.duration - state_.segment_elapsed.seconds();
  for (std::size_t i = state_.segment + 1; i + 1 < state_.plan.size(); ++i) {
    sum += state_.plan[i].duration;
  }
  return sum > 0.0 ? sum : 0.0;
}

}  // namespace stator::control
