#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/control/motion_controller/motion_controller_settings.hpp"
#include "stator/control/ramp/ramp_generator.hpp"

namespace stator::control::motion_controller {

/// AP 128; 1 is reserved (A48).
enum class Mode : std::uint8_t {
  positioning = 0,
  velocity = 2,
  hold = 3,  ///< keeps the velocity it is entered with; targets and accelerations have no effect
};

/// Stop switches that are active and enabled.
struct StopConditions {
  bool left = false;
  bool right = false;

  friend constexpr bool operator==(const StopConditions&, const StopConditions&) = default;
};

/// The chip's ramp: a RampGenerator with registers in the chip's units, a position counter of 32
/// bits that wraps, and stops that hold in one direction only.
///
/// A stop condition is a level: motion towards it ends, with the stop deceleration (soft) or at
/// once, motion away from it stays possible, and when it goes the motion to the target goes on.
/// Stops are linear whatever the bow. Position limits are stop conditions at a position. The motor
/// comes to rest on them: a target beyond is replaced by the limit; in velocity mode braking (soft)
/// begins where it ends on the limit, or the velocity ends there with 10^12 pps/s (hard). A motor
/// that is beyond its limit may only move back.
///
/// A target counts as 32-bit difference to the position, so the way to it is never longer than 2^31
/// microsteps and may lead across the end of the counter.
class MotionControllerRamp {
 public:
  MotionControllerRamp();

  void configure(const RampSettings& settings, const PositionLimits& limits, bool soft_stop);

  /// AP 0: positioning mode, to `target`.
  void move_to(std::int32_t target);
  /// ROR, ROL: velocity mode, to `velocity`.
  void rotate(std::int32_t velocity);
  /// AP 2: has an effect in velocity mode only.
  void set_target_velocity(std::int32_t velocity);
  /// AP 128.
  void set_mode(Mode mode);
  /// AP 1: names the present position anew, without moving the motor. The target keeps its number.
  void set_position(std::int32_t position);
  /// Writes the target register without a change of mode or a motion; velocity mode only.
  void set_idle_target(std::int32_t target) { target_position_ = target; }
  /// Velocity mode with velocity 0 from this moment on, without a ramp.
  void stop_at_once();
  /// While set, position limits are not looked at.
  void ignore_limits(bool ignore);

  /// Lets `period` pass, in which `stops` hold from its begin.
  void advance(const StopConditions& stops, base::SimDuration period);

  [[nodiscard]] Mode mode() const { return mode_; }
  [[nodiscard]] std::int32_t target_position() const { return target_position_; }
  [[nodiscard]] std::int32_t target_velocity() const { return target_velocity_; }
  [[nodiscard]] std::int32_t position() const {
    return static_cast<std::int32_t>(ramp_.position().microsteps);
  }
  /// The counter before it is cut to 32 bits.
  [[nodiscard]] std::int64_t unwrapped_position() const { return ramp_.position().microsteps; }
  /// In the chip's units, to the nearest.
  [[nodiscard]] std::int32_t velocity() const;
  /// The same, of the acceleration (signed).
  [[nodiscard]] std::int32_t acceleration() const;
  [[nodiscard]] bool at_rest() const { return ramp_.at_rest(); }
  /// The bow exceeds acceleration or deceleration: the chip's profile would oscillate (RMP-004).
  /// Ours does not; it becomes nearly a trapezoid.
  [[nodiscard]] bool bow_too_large() const;
  [[nodiscard]] const RampGenerator& generator() const { return ramp_; }

 private:
  [[nodiscard]] RampLimits linear_limits(double velocity) const;
  [[nodiscard]] double room_right() const;
  [[nodiscard]] double room_left() const;
  [[nodiscard]] bool right_blocked() const;
  [[nodiscard]] bool left_blocked() const;
  [[nodiscard]] double wanted_direction() const;
  [[nodiscard]] std::int64_t goal_within_limits() const;
  void aim();
  void replan();
  void follow();
  void brake();
  void watch(double velocity, base::SimDuration period);
  void look_ahead(double velocity, base::SimDuration period);
  void approach_limit(double velocity, double room);

  RampGenerator ramp_;
  RampSettings settings_;
  PositionLimits limits_;
  RampLimits positioning_;  ///< settings in pps
  RampLimits turning_;      ///< the same, for velocity mode
  double stop_deceleration_ = 0.0;
  bool soft_stop_ = false;
  bool limits_ignored_ = false;

  Mode mode_ = Mode::positioning;
  std::int32_t target_position_ = 0;
  std::int32_t target_velocity_ = 0;
  std::int64_t goal_ = 0;       ///< of positioning, in the counter before it is cut
  double held_velocity_ = 0.0;  ///< pps

  StopConditions stops_;
  bool braking_ = false;      ///< because of a stop condition
  bool approaching_ = false;  ///< a limit, in velocity or hold mode
};

}  // namespace stator::control::motion_controller
