#pragma once

#include <cstdint>

#include "base/sim_time.hpp"
#include "control/coil_current_selector.hpp"
#include "drive/driver_settings.hpp"
#include "drive/motion_units.hpp"
#include "drive/power_state_machine.hpp"

namespace stator::drive {

/// What CiA 402 leaves to the manufacturer; the device fills it from its own objects and brings it
/// up to date before each Axis::apply() and Axis::tick().
struct AxisSettings {
  MotionUnits units;
  std::int64_t microsteps_per_revolution = 51'200;
  std::uint8_t microstep_resolution = 8;  ///< microsteps per full step as a power of two
  PowerDelays delays;
  double stop_deceleration = 0.0;     ///< pps/s at a limit switch; 0 stops hard
  bool encoder_reversed = false;      ///< the encoder counts against the motor
  bool position_from_encoder = true;  ///< the demand position starts at the encoder's position
  control::CoilCurrentSettings currents;
  double full_scale_current = 3.0;  ///< A, peak of a coil at 100 %
  bool automatic_brake = false;     ///< false: the brake is not the drive's business
  bool chopper_enabled = true;      ///< false: the bridge stays off, the motor free-wheels
  DriverSettings driver;
};

/// The surroundings of an axis, from the network and from inputs, as of now.
struct AxisConditions {
  bool network_operational = false;
  bool supply_present = true;
  bool negative_limit_switch = false;  ///< pressed, after polarity; false if not used
  bool positive_limit_switch = false;
  bool shutdown_switch = false;  ///< the enable signal of the power stages is missing
};

}  // namespace stator::drive
