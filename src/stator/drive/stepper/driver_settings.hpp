#pragma once

#include "stator/control/stepper/chopper.hpp"
#include "stator/control/stepper/cool_step.hpp"
#include "stator/control/stepper/stall_guard.hpp"
#include "stator/control/stepper/stealth_chop.hpp"

namespace stator::drive {

/// Where a driver chip warns and switches off. The document of the TMCM-3315 states none of these;
/// they are those of Trinamic's drivers of the time.
struct DriverLimits {
  double warning_temperature = 120.0;    ///< degree Celsius
  double shutdown_temperature = 150.0;   ///< degree Celsius
  double temperature_hysteresis = 20.0;  ///< K below a limit at which its flag goes away
  double undervoltage = 8.0;             ///< V below which the stage cannot drive a motor
  double undervoltage_hysteresis = 0.5;  ///< V above it at which it can again
};

/// Registers of the driver chip of one axis.
struct DriverSettings {
  control::StallGuardSettings stall_guard;
  double stall_velocity = 0.0;  ///< pps above which a stall stops the motor; 0: never
  control::CoolStepSettings cool_step;
  double cool_step_velocity = 0.0;  ///< pps above which CoolStep acts
  control::StealthChopSettings stealth_chop;
  control::ChopperSettings chopper;
  bool short_protection = true;
  DriverLimits limits;
};

}  // namespace stator::drive
