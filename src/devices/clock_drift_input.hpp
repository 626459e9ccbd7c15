#pragma once

#include "devices/input.hpp"
#include "ethercat/slave_controller.hpp"

namespace stator::devices {

/// "clock_drift": parts per billion by which the oscillator of a slave controller is off, beside
/// what its configuration says. Ten times what crystals for EtherCAT may be off, and more.
[[nodiscard]] inline Input clock_drift_input(ethercat::SlaveController& controller) {
  using Controller = ethercat::SlaveController;
  return {"clock_drift", "ppb", -1e6, 1e6,
          base::Delegate<void(double)>::bind<&Controller::set_clock_drift>(controller)};
}

}  // namespace stator::devices
