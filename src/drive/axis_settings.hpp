#pragma once

#include <cstdint>

#include "base/sim_time.hpp"
#include "control/closed_loop_controller.hpp"
#include "control/coil_current_selector.hpp"
#include "drive/driver_settings.hpp"
#include "drive/motion_units.hpp"
#include "drive/power_state_machine.hpp"
#include "drive/reference_switches.hpp"

namespace stator::drive {

/// Of a profile, what CiA 402 has no objects for. pps and pps/s; see control::RampLimits.
struct RampSettings {
  double start_velocity = 0.0;
  double start_acceleration = 0.0;
  double break_velocity = 0.0;
  double final_deceleration = 0.0;
  double stop_deceleration = 0.0;  ///< after an end velocity and at limit switches; 0 = at once
  double bow_factor = 1.0;         ///< multiplies the jerks of 60A4h
};

/// What CiA 402 leaves to the manufacturer; the device fills it from its own objects and brings it
/// up to date before each Axis::apply() and Axis::tick().
struct AxisSettings {
  MotionUnits units;
  std::int64_t microsteps_per_revolution = 51'200;
  std::uint8_t microstep_resolution = 8;  ///< microsteps per full step as a power of two
  PowerDelays delays;
  RampSettings ramp;
  bool encoder_reversed = false;      ///< the encoder counts against the motor
  bool position_from_encoder = true;  ///< the demand position starts at the encoder's position
  ReferenceSettings reference;
  control::CoilCurrentSettings currents;
  control::ClosedLoopSettings closed_loop;
  double full_scale_current = 3.0;  ///< A, peak of a coil at 100 %
  bool chopper_enabled = true;      ///< false: the bridge stays off, the motor free-wheels
  DriverSettings driver;
};

/// The surroundings of an axis, from the network and from inputs, as of now.
struct AxisConditions {
  bool network_operational = false;
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
