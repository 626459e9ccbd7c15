#pragma once

#include "devices/tmcm_3315_module.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::devices {

/// A module with a motor that turns under a load.
class DriverModule : public Tmcm3315Module {
 protected:
  explicit DriverModule(const Tmcm3315Configuration& configuration = {})
      : Tmcm3315Module(configuration) {}

  /// Operation enabled in profile velocity, at `velocity` pps.
  void run_at(std::int32_t velocity, unsigned motor = 0) {
    set_profile(motor, 0, 512'000);
    enable(motor, 3);
    write<std::int32_t>(of_motor(motor, 0x60FF), velocity);
    bus_->pass(1_s);
  }
  /// Changes the load of axis 0 slowly, so that nothing swings.
  void load_slowly(double torque) {
    for (int n = 1; n <= 50; ++n) {
      set_input("axis0.load_torque", load_ + (torque - load_) * n / 50.0);
      bus_->pass(10_ms);
    }
    load_ = torque;
  }
  std::uint16_t stall_guard() { return bus_->upload<std::uint16_t>(0x2101); }
  std::uint8_t driver_flags(unsigned motor = 0) {
    return bus_->upload<std::uint8_t>(of_motor(motor, 0x2102));
  }
  std::uint8_t error_register() { return bus_->upload<std::uint8_t>(0x1001); }

  double load_ = 0.0;
};

}  // namespace stator::devices
