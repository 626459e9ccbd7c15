#pragma once

#include <cstdint>
#include <limits>

#include "stator/base/sim_time.hpp"
#include "stator/control/ramp/interpolation_profile.hpp"
#include "stator/control/ramp/motion_plan.hpp"
#include "stator/control/ramp/ramp_limits.hpp"

namespace stator::control {

/// What the generator was told last.
enum class RampMode : std::uint8_t {
  stop,             ///< brake to rest and stay
  position,         ///< ramp to a target position
  velocity,         ///< ramp to a target velocity
  follow_position,  ///< csp: interpolate to the master's next position, then hold it
  follow_velocity,  ///< csv: interpolate to the master's next velocity, then hold it
};

/// Everything a RampGenerator remembers; copy it to take a snapshot.
struct RampState {
  RampMode mode = RampMode::stop;
  RampLimits limits;
  std::int64_t target_position = 0;                                   ///< microsteps
  double target_velocity = 0.0;                                       ///< pps
  double maximum_velocity = std::numeric_limits<double>::infinity();  ///< pps
  std::int64_t origin = 0;  ///< motor position minus position, microsteps

  MotionPlan plan;
  std::size_t segment = 0;            ///< index of the segment being played
  MotionSegment playing;              ///< it, its times counted from the tick it was entered in
  base::SimDuration segment_elapsed;  ///< since that tick

  MotionState now;
};

/// Makes the position set-point of one axis: plans a motion in closed form when it is told
/// something new and plays the plan. Time enters as integer nanoseconds counted from the begin of a
/// segment, and the instants at which one segment follows another are solved, not rounded to a
/// tick. Hence the trace is the analytic profile whatever the tick, arrival is exactly on the
/// target with velocity exactly 0, and nothing drifts. Commands may come at any time and act at
/// once from the present position, velocity and, with s-shaped ramps, acceleration.
///
/// Units: microsteps (see MicrostepPosition for range and wrapping), pps, pps/s. Commands do not
/// allocate and never fail; only + - * / and square root are used.
class RampGenerator {
 public:
  RampGenerator();

  /// The largest velocity (pps) that a ramp of this generator can hold. The cyclic modes
  /// interpolate as fast as their targets want; where a ramp or a stop takes over from there, it
  /// begins with this. Without a call there is no such bound.
  void set_maximum_velocity(double velocity) { state_.maximum_velocity = velocity; }

  /// Travels to `target` and rests there. A target already under way is kept without planning anew.
  void move_to(std::int64_t target, const RampLimits& limits);
  /// Takes up the signed `velocity` and keeps it; limits.velocity caps its magnitude.
  void move_at_velocity(double velocity, const RampLimits& limits);
  /// Changes the limits of the motion under way (position and velocity mode; otherwise no effect
  /// until the next command).
  void set_limits(const RampLimits& limits);

  /// csp: reach `target` after `period`, then hold it.
  void follow_position(std::int64_t target, base::SimDuration period);
  /// csv: reach `velocity` after `period`, then hold it.
  void follow_velocity(double velocity, base::SimDuration period);

  /// Halt, quick stop: brakes to rest with `deceleration`; 0 stops at once. The position rested at
  /// is wherever braking ends, mostly between two microsteps. Repeated calls with a new
  /// deceleration act on the braking under way.
  void stop(double deceleration);
  /// Halt on a profile: as stop(limits.deceleration), with the bows of an s-shaped ramp. Calls
  /// while braking act on the braking under way.
  void stop(const RampLimits& limits);
  /// Limit switch, stall: velocity 0 from this moment.
  void stop_at_once() { stop(0.0); }

  /// Renames the present whole microstep to `microsteps` (homing, encoder preset) without moving
  /// the motor; the fraction stays, as in a chip whose counter is written. Motion under way is
  /// stopped at once.
  void set_position(std::int64_t microsteps);

  /// Renames every position by adding `microsteps`, without moving the motor; a motion under way
  /// goes on to where it was going.
  void shift(std::int64_t microsteps);

  /// Lets `duration` pass (any length, not negative).
  void advance(base::SimDuration duration) {
    state_.segment_elapsed += duration;
    double time = state_.segment_elapsed.seconds();
    // A segment holds up to and including its last instant, so that a csp axis fed on time shows
    // the velocity it travels with, not the 0 of the hold that would follow.
    if (time > state_.playing.duration) [[unlikely]] {
      leave_segment(time);
      time = 0.0;
    }
    state_.now = state_.playing.at(time);
  }

  /// Set-point in the coordinates of the latest set_position().
  [[nodiscard]] const MicrostepPosition& position() const { return state_.now.position; }
  /// Whole microsteps since power-on, untouched by set_position(): what the sequencer is driven
  /// with.
  [[nodiscard]] std::int64_t motor_microsteps() const {
    return state_.now.position.microsteps + state_.origin;
  }
  [[nodiscard]] double velocity() const { return state_.now.velocity; }
  /// Signed; a negative value at positive velocity means losing speed.
  [[nodiscard]] double acceleration() const { return state_.now.acceleration; }
  /// Jerk (magnitude, pps/s^2) with which the plan under way ends the present acceleration; 0 = in
  /// a step, or there is none.
  [[nodiscard]] double end_jerk() const;
  [[nodiscard]] RampPhase phase() const { return state_.playing.phase; }
  [[nodiscard]] RampMode mode() const { return state_.mode; }
  [[nodiscard]] const RampLimits& limits() const { return state_.limits; }
  [[nodiscard]] std::int64_t target_position() const { return state_.target_position; }
  [[nodiscard]] double target_velocity() const { return state_.target_velocity; }
  /// Velocity 0 and no motion planned.
  [[nodiscard]] bool at_rest() const;
  /// Position mode: resting exactly on the target. Velocity mode: the target velocity is there.
  [[nodiscard]] bool target_reached() const;
  /// Microsteps (magnitude) to rest if the axis braked with `limits` from this moment on.
  [[nodiscard]] double braking_distance(const RampLimits& limits) const;
  /// Seconds until the plan under way comes to rest or to its final velocity.
  [[nodiscard]] double remaining_time() const;

  [[nodiscard]] const RampState& state() const { return state_; }
  void restore(const RampState& state) { state_ = state; }

 private:
  void play(const MotionPlan& plan);
  [[nodiscard]] MotionState begin_of_ramp() const;
  void replan();
  void leave_segment(double time);
  void enter(std::size_t segment, double lead);

  RampState state_;
};

}  // namespace stator::control
