#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "stator/base/sim_time.hpp"

namespace stator::tests {

/// Why an axis has to come to rest; `none`: it may move.
enum class StopCause : std::uint8_t {
  none,
  halt,               ///< bit 8 of the controlword, 605Dh
  quick_stop,         ///< 605Ah
  shutdown,           ///< transition 8, 605Bh
  disable_operation,  ///< transition 5, 605Ch
  fault_reaction,     ///< 605Eh
  network,            ///< the network left its operational state: quick stop ramp
  mode_change,        ///< 6060h is not 6061h yet: slow down ramp
  command,            ///< TMCL: MST, and rotation with a speed of 0
};
inline constexpr std::size_t kStopCauses = 9;
[[nodiscard]] std::string_view to_text(StopCause cause);

/// What power is switched off for.
enum class PowerOff : std::uint8_t {
  not_allowed,      ///< only a shaft that stands may lose its torque
  disable_voltage,  ///< CiA 402-2 transitions 7, 9, 10, 12
  option_0,         ///< an option code of 0: disable the drive function at once
  stage_fault,      ///< supply, short, temperature: the stage protects itself
  switched_off,     ///< no supply of the logic, reset, shutdown pin
};

/// Velocities are rev/s, positions revolutions, accelerations rev/s².
struct StopState {
  StopCause cause = StopCause::none;
  /// With which the motor comes to rest; infinite: at once, as far as the torque goes.
  double deceleration = std::numeric_limits<double>::infinity();
  /// The ramp says nothing: a deceleration of 0, or a torque that is only taken away.
  bool unbounded = false;
};

/// How a velocity is commanded at present.
enum class Guidance : std::uint8_t {
  ramp,    ///< the demand goes by ramps: profile modes, homing, everything in TMCL
  cyclic,  ///< the demand follows the master's set-points
  torque,  ///< the demand follows the shaft
};

/// What happened at an axis in a millisecond: the truth of the plant, what the drive makes of it,
/// and what its objects demand. Made by a DriveUnderTest, judged by DriveInvariants.
struct Sample {
  base::SimTime time;

  // The plant.
  double position = 0.0;
  double velocity = 0.0;
  double load = 0.0;          ///< N m on the shaft from outside, positive = forward
  double inertia = 1e-5;      ///< kg m², of rotor and load
  double friction = 0.0;      ///< N m that brakes a shaft, dry
  double torque_limit = 0.0;  ///< N m the motor can brake with at the current in force
  double current = 0.0;       ///< A, peak of the current vector
  double current_limit = std::numeric_limits<double>::infinity();  ///< A, in force
  double supply = 24.0;                                            ///< V at the power stage
  double source = 24.0;                                            ///< V of the supply behind
  double supplied_energy = 0.0;                                    ///< J the bridge took
  bool power = false;                                              ///< the bridge is on
  bool jammed = false;
  bool negative_switch = false;  ///< pressed and in use
  bool positive_switch = false;

  // The drive, as its objects show it.
  std::uint16_t statusword = 0;
  int mode = 0;
  Guidance guidance = Guidance::ramp;
  bool enabled = false;    ///< Operation enabled: set-points are obeyed but for `stop`
  bool searching = false;  ///< homing, which passes switches and limits
  double demand = 0.0;     ///< position
  double demand_velocity = 0.0;
  double shown_position = 0.0;  ///< 6064h
  double shown_velocity = 0.0;  ///< 606Ch
  double shown_torque = 0.0;    ///< N m of 6077h

  // What is commanded, and the limits in force.
  StopState stop{};
  PowerOff power_off = PowerOff::not_allowed;  ///< why power may be off that was on before
  bool has_to_be_off = false;      ///< Disable voltage is commanded, and no brake is waited for
  bool position_renamed = false;   ///< 6064h got another origin, or comes from another sensor
  bool reference_changed = false;  ///< the demand may be anything: mode, power, origin
  double acceleration = 0.0;       ///< largest with which the demand may change on a ramp
  double switch_deceleration = 0.0;
  double limit_deceleration = 0.0;  ///< at a software limit
  double largest_velocity = std::numeric_limits<double>::infinity();
  double lower_limit = -std::numeric_limits<double>::infinity();
  double upper_limit = std::numeric_limits<double>::infinity();
  double target = 0.0;           ///< position that pp or csp goes to
  double target_velocity = 0.0;  ///< of pv and csv
  double window = 0.0;           ///< around `target`, half
  double velocity_window = std::numeric_limits<double>::infinity();
  double end_velocity = 0.0;        ///< with which a profile may end in a step
  bool target_reached_bit = false;  ///< statusword bit 10, where it has that meaning
  bool follows_bit = false;         ///< bit 12 in cyclic modes
};

/// What an axis can do, for all of a recording.
struct DriveTraits {
  double standstill = 0.1;         ///< rev/s below which its shaft counts as standing, with ripple
  double settle = 0.02;            ///< rev by which a shaft may move on beyond what is allowed
  double reaction = 0.02;          ///< s from a command to torque in the other direction
  double reversal = 6e-3;          ///< s until its torque brakes
  double lag = 0.01;               ///< s that a shaft stays behind its ramp at `inertia`
  double bandwidth = 100.0;        ///< rad/s of the velocity loop at `inertia`
  double inertia = 1e-5;           ///< kg m² the loops are tuned for
  double integral_time = 0.1;      ///< s in which a load is taken over
  double follows_within = 0.02;    ///< rev between demand and shaft that is no lag
  double position_error = 0.01;    ///< rev between 6064h and the plant
  double velocity_error = 0.5;     ///< rev/s between 606Ch and the plant at constant velocity
  double no_load_velocity = 1e9;   ///< rev/s per V of supply above which torque is not guaranteed
  double overvoltage = 1e9;        ///< V above which the bridge has to be off
  double current_allowance = 1.0;  ///< A above the limit in force
  bool has_statusword = true;      ///< as CiA 402 has it
  bool shaft_is_counter = false;   ///< a stepper without encoder: what it counted is its shaft
};

}  // namespace stator::tests
