#pragma once

#include <cstdint>

#include "stator/control/servo/servo_settings.hpp"
#include "stator/drive/motion/axis_settings.hpp"

namespace stator::drive {

/// Where a servo drive warns and switches off. The document of the TMCC160 states none of these.
struct ServoLimits {
  double undervoltage = 7.0;             ///< V below which the stage cannot drive a motor
  double overvoltage = 28.0;             ///< V above which it switches off
  double voltage_hysteresis = 0.5;       ///< V back from a limit at which its flag goes away
  double warning_temperature = 100.0;    ///< degree Celsius
  double shutdown_temperature = 120.0;   ///< degree Celsius
  double temperature_hysteresis = 10.0;  ///< K below a limit at which its flag goes away
};

/// What a servo axis has beside AxisSettings, in the units of its objects; the device brings it up
/// to date before ServoAxis::apply() and tick().
struct ServoSettings {
  control::ServoControllerSettings controller;
  std::uint32_t maximum_acceleration = 2000;  ///< rpm/s, bounds every ramp (TMCC160 2020h:03)
  ServoLimits limits;
  double target_reached_velocity = 500.0;    ///< rpm (TMCC160 2050h:06)
  std::int64_t target_reached_distance = 5;  ///< increments (TMCC160 2050h:07)
  /// rpm that the velocity may differ from the target of pv for it to count as reached.
  double velocity_window = 50.0;
};

/// The choices of a TMCC160 (its decisions ).
inline constexpr ProfileBehaviour kServoBehaviour{.zero_velocity_is_largest = true,
                                                  .end_velocity_goes_on = true,
                                                  .stops_behind_software_limits = true,
                                                  .slows_down_at_switches = true,
                                                  .stops_release_torque = true,
                                                  .homing_needs_speeds = true,
                                                  .homing_starts_on_edge = true};

}  // namespace stator::drive
