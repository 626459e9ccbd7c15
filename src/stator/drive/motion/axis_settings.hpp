#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include "stator/base/sim_time.hpp"
#include "stator/drive/motion/motion_units.hpp"
#include "stator/drive/motion/reference_switches.hpp"
#include "stator/drive/power/power_state_machine.hpp"

namespace stator::drive {

/// Of a profile, what CiA 402 has no objects for. pps and pps/s; see control::RampLimits.
struct RampSettings {
  double start_velocity = 0.0;
  double start_acceleration = 0.0;
  double break_velocity = 0.0;
  double final_deceleration = 0.0;
  double stop_deceleration = 0.0;  ///< after an end velocity and at limit switches; 0 = at once
  double bow_factor = 1.0;         ///< multiplies the jerks of 60A4h
  bool active = true;              ///< false: targets of pp and pv are set-points at once
};

/// How products differ in what CiA 402 leaves open. The defaults are those of the TMCM-3315.
struct ProfileBehaviour {
  /// 6081h = 0 means the largest velocity there is; otherwise no motion.
  bool zero_velocity_is_largest = false;
  /// The motor goes on with 6082h behind the target; otherwise the deceleration of 6084h ends
  /// there and the motor stops on the target.
  bool end_velocity_goes_on = false;
  /// A velocity or torque is stopped when the position has passed a software limit; otherwise the
  /// axis brakes so that it comes to rest on the limit.
  bool stops_behind_software_limits = false;
  /// A limit switch stops the motor with 6084h (609Ah while homing); otherwise with
  /// RampSettings::stop_deceleration.
  bool slows_down_at_switches = false;
  /// Halt in cst takes the torque away, and a stop without a deceleration to brake with ends in
  /// coasting; otherwise both brake.
  bool stops_release_torque = false;
  /// A homing method that moves does not start with a speed or an acceleration of 0.
  bool homing_needs_speeds = false;
  /// Homing starts where bit 4 of the controlword rises in mode 6; otherwise its level counts.
  bool homing_starts_on_edge = false;
  /// Homing as CiA 402-2 has it: halt holds a run, bit 13 of the statusword tells an error, bit 10
  /// alone also that none has started, and methods 35 and 37 take the home offset. Otherwise halt
  /// is not looked at, there is no bit 13, and these methods make the position 0.
  bool homing_by_profile = false;
  /// 60B1h in csp and 60B2h in csp and csv go to the loops inside as feed-forward; otherwise they
  /// mean nothing there.
  bool offsets_feed_forward = false;
};

/// What torque objects (6071h, 6077h, 60B2h) count in: current that makes torque.
struct TorqueUnit {
  double amperes = 1e-3;     ///< A (peak) of one unit: mA
  double per_ampere = 1000;  ///< its inverse

  /// Thousandths of a rated current of `milliamperes` RMS; more than 0.
  [[nodiscard]] static constexpr TorqueUnit per_mille_of(double milliamperes) {
    constexpr double kPeak = 1.4142135623730951;  // of a sine with the RMS value 1
    const double amperes = milliamperes * 1e-6 * kPeak;
    return {.amperes = amperes, .per_ampere = 1.0 / amperes};
  }
};

/// Where positioning counts as finished if 6067h monitors nothing.
struct PositionEnd {
  std::int64_t distance = 0;  ///< of the actual position from the target, increments
  double velocity = 0.0;      ///< pps, largest
};

/// What homing methods -1 to -6 work with.
struct HardStopSettings {
  double current = 0.0;                 ///< A, that tells a hard stop; 0: none is looked for
  std::int64_t positive_clearance = 0;  ///< increments back from the stop in positive direction
  std::int64_t negative_clearance = 0;  ///< and from the other one
};

/// What CiA 402 leaves to the manufacturer; the device fills it from its own objects and brings it
/// up to date before each Axis::apply() and Axis::tick().
struct AxisSettings {
  MotionUnits units;
  PowerDelays delays;
  RampSettings ramp;
  ProfileBehaviour behaviour;
  bool position_from_encoder = true;  ///< the demand position starts at the encoder's position
  ReferenceSettings reference;
  HardStopSettings hard_stop;
  std::optional<PositionEnd> position_end;  ///< none: the demand rests on the target
  /// pps that the actual velocity may differ from the target of pv for it to count as reached.
  double velocity_window = std::numeric_limits<double>::infinity();
  base::SimDuration velocity_window_time;  ///< for which it has to stay that near
  /// pps above which the motor counts as turning in pv; none: statusword bit 12 stays 0 there.
  std::optional<double> velocity_threshold;
  base::SimDuration velocity_threshold_time;  ///< for which it has to be above
  TorqueUnit torque_unit;
  double maximum_torque = std::numeric_limits<double>::infinity();  ///< A, of any torque target
  /// Velocity objects count against the direction of positions (607Eh).
  bool velocity_reversed = false;

  /// pps of 60FFh or 60B1h.
  [[nodiscard]] double velocity_of(std::int64_t object) const {
    return units.pps(static_cast<double>(velocity_reversed ? -object : object));
  }
  /// 606Bh or 606Ch of `pps`.
  [[nodiscard]] std::int32_t velocity_object(double pps) const {
    return units.velocity_object(velocity_reversed ? -pps : pps);
  }
  /// A of 6071h or of its sum with 60B2h, clipped to the largest torque.
  [[nodiscard]] double torque_of(std::int64_t object) const {
    return std::clamp(static_cast<double>(object) * torque_unit.amperes, -maximum_torque,
                      maximum_torque);
  }
};

/// The surroundings of an axis, from the network and from inputs, as of now.
struct AxisConditions {
  bool network_operational = false;    ///< controlwords are obeyed
  bool negative_limit_switch = false;  ///< pressed, after polarity; false if not used
  bool positive_limit_switch = false;
  bool shutdown_switch = false;  ///< the enable signal of the power stages is missing
  bool home_switch = false;

  void set_switches(const SwitchStates& pressed) {
    negative_limit_switch = pressed.negative_limit;
    positive_limit_switch = pressed.positive_limit;
    home_switch = pressed.home;
  }
  [[nodiscard]] SwitchStates switches() const {
    return {negative_limit_switch, positive_limit_switch, home_switch};
  }
};

}  // namespace stator::drive
