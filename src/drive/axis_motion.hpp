#pragma once

#include <cstdint>
#include <optional>

#include "base/sim_time.hpp"
#include "control/ramp_generator.hpp"
#include "drive/axis_objects.hpp"
#include "drive/axis_settings.hpp"

namespace stator::drive {

/// Limit switches that a homing motion may pass.
struct PassedSwitches {
  bool negative_limit = false;
  bool positive_limit = false;
};

/// What the modes of operation may do with the motor: every set-point passes here, where software
/// position limits (607Dh) and limit switches hold for all modes.
///
/// Positions are 64-bit microsteps; the objects show the lower 32 bits. An absolute target means
/// the position with these lower bits in the present turn of the 32-bit counter.
class AxisMotion {
 public:
  /// Everything must outlive the object.
  AxisMotion(const AxisObjects& objects, const AxisSettings& settings,
             const AxisConditions& conditions)
      : objects_(objects), settings_(settings), conditions_(conditions) {}

  /// Absolute target of profile position in 64 bits.
  [[nodiscard]] std::int64_t absolute(std::int32_t object) const;
  /// Cyclic target in 64 bits: the position nearest to the present one with the lower bits of
  /// `sum`, so that an endless axis passes the end of the 32-bit counter; absolute where a software
  /// limit holds.
  [[nodiscard]] std::int64_t cyclic(std::int64_t sum) const;

  /// Travels on the profile of 6081h to 6084h, 6086h and 60A4h; the target is clamped to the
  /// software limits. Returns the target in force.
  std::int64_t move_to(std::int64_t target);
  /// Takes up `velocity` (pps) with 6083h, 6084h, 6086h and 60A4h.
  void move_at_velocity(double velocity);
  /// Interpolates to a cyclic target within 60C2h; clamped to the software limits.
  void follow_position(std::int64_t target);
  void follow_velocity(double velocity);
  /// Homing: takes up `velocity` (pps) with 609Ah. Software limits do not hold, for the position
  /// means nothing yet; a limit switch that may not be passed stops the motor.
  void search_at_velocity(double velocity, const PassedSwitches& passed);
  /// Homing: travels to `target` in the same way; `velocity` is not negative.
  void search_to(std::int64_t target, double velocity, const PassedSwitches& passed);

  /// cst: `amperes` of phase current (signed) at the largest load angle instead of a set-point. At
  /// a limit the axis brakes and holds its position until the torque points away from it.
  void apply_torque(double amperes);
  /// The torque in force; none while set-points are.
  [[nodiscard]] std::optional<double> torque() const { return torque_; }
  /// While a torque is in force the set-point follows the rotor, which is `deviation` microsteps
  /// behind and turns with `velocity` (pps): whatever comes next starts from where the motor is.
  /// Call every control period.
  void follow_rotor(double deviation, double velocity);

  /// Brakes with 6084h (and the bows of a profile under way), after a homing motion with 609Ah, by
  /// the quick stop ramp with 6085h, or at once.
  void brake(Braking braking);
  /// Renames the present position; a motion under way ends at once.
  void set_position(std::int64_t microsteps) { ramp_.set_position(microsteps); }

  /// Applies changed profile objects, software limits and limit switches. Call every control period
  /// of length `period`.
  void supervise(base::SimDuration period);
  void advance(base::SimDuration duration) { ramp_.advance(duration); }

  [[nodiscard]] const control::RampGenerator& ramp() const { return ramp_; }
  [[nodiscard]] std::int64_t position() const { return ramp_.position().microsteps; }
  /// The position at which the motor had made `motor_microsteps` since power-on.
  [[nodiscard]] std::int64_t position_of(std::int64_t motor_microsteps) const {
    return position() - (ramp_.motor_microsteps() - motor_microsteps);
  }
  [[nodiscard]] double velocity() const { return ramp_.velocity(); }
  [[nodiscard]] bool at_rest() const { return ramp_.at_rest(); }
  /// A software limit or a limit switch holds back what was commanded last.
  [[nodiscard]] bool limited() const { return limited_; }

  /// 607Dh corrected by the home offset, in the present turn of the 32-bit counter; none for the
  /// extreme values of INTEGER32.
  [[nodiscard]] std::optional<std::int64_t> lower_limit() const;
  [[nodiscard]] std::optional<std::int64_t> upper_limit() const;

 private:
  [[nodiscard]] std::int64_t turn() const;
  [[nodiscard]] std::int64_t clamped(std::int64_t target);
  [[nodiscard]] bool switch_blocks(double direction) const;
  [[nodiscard]] bool limit_blocks(double direction) const;
  [[nodiscard]] control::RampLimits profile_limits() const;
  [[nodiscard]] control::RampLimits velocity_limits() const;
  [[nodiscard]] control::RampLimits search_limits(double velocity) const;
  [[nodiscard]] bool search_blocked(double direction, const PassedSwitches& passed);
  void stop_before_software_limit(base::SimDuration period);
  void end_torque() {
    torque_.reset();
    held_direction_ = 0.0;
  }
  /// A limit ends the torque in force.
  void hold_against(double direction);

  const AxisObjects& objects_;
  const AxisSettings& settings_;
  /// Which limits a change of the profile objects alters in flight.
  enum class Profile : std::uint8_t { none, positioning, velocity, search };

  const AxisConditions& conditions_;
  control::RampGenerator ramp_;
  Profile profile_ = Profile::none;
  PassedSwitches passed_;  ///< in Profile::search
  bool limited_ = false;
  std::optional<double> torque_;  ///< A
  double held_direction_ = 0.0;   ///< of the torque that ran into a limit, 0 = none
};

}  // namespace stator::drive
