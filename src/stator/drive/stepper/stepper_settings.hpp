#pragma once

#include <cstdint>

#include "stator/control/motion_controller/coil_current_selector.hpp"
#include "stator/control/stepper/closed_loop_controller.hpp"
#include "stator/drive/stepper/driver_settings.hpp"

namespace stator::drive {

/// What a stepper axis has beside AxisSettings; the device brings it up to date with them.
struct StepperSettings {
  std::int64_t microsteps_per_revolution = 51'200;
  std::uint8_t microstep_resolution = 8;  ///< microsteps per full step as a power of two
  bool encoder_reversed = false;          ///< the encoder counts against the motor
  control::CoilCurrentSettings currents;
  control::ClosedLoopSettings closed_loop;
  double full_scale_current = 3.0;  ///< A, peak of a coil at 100 %
  bool chopper_enabled = true;      ///< false: the bridge stays off, the motor free-wheels
  DriverSettings driver;
};

}  // namespace stator::drive
