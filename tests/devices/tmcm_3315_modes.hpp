#pragma once

#include <cstdint>

#include "devices/tmcm_3315_damped_axis.hpp"
#include "devices/tmcm_3315_module.hpp"

namespace stator::devices {

/// A module whose axis 0 can be set in motion in each mode of operation.
class Tmcm3315Modes : public Tmcm3315Module {
 protected:
  Tmcm3315Modes() : Tmcm3315Module(damped_axis()) { go_operational(); }

  double velocity() { return signal("axis0.velocity_demand"); }
  double position() { return signal("axis0.position_demand"); }
  std::int8_t mode_display() { return bus_->upload<std::int8_t>(0x6061); }
  void set_interpolation(std::uint8_t value, std::int8_t index) {
    write<std::uint8_t>(0x60C2, value, 1);
    write<std::int8_t>(0x60C2, index, 2);
  }
  /// A new module whose axis 0 travels at 10000 pps in `mode`; slow-down ramp 40000, quick-stop
  /// ramp 80000 pps/s.
  void run_in(std::int8_t mode) {
    renew(damped_axis());
    go_operational();
    write<std::uint32_t>(0x6081, 10'000);
    write<std::uint32_t>(0x6083, 100'000);
    write<std::uint32_t>(0x6084, 40'000);
    write<std::uint32_t>(0x6085, 80'000);
    set_interpolation(100, 0);  // 100 s to the next set-point
    enable(0, mode);
    if (mode == 1) {
      start_move(0, 1'000'000);
    } else if (mode == 8) {
      write<std::int32_t>(0x607A, 1'000'000);
    } else {
      if (mode == 9) {
        set_interpolation(1, -3);
      }
      write<std::int32_t>(0x60FF, 10'000);
    }
    bus_->pass(500_ms);
    ASSERT_NEAR(velocity(), 10'000.0, 5.0) << "mode " << int{mode};
  }
};

}  // namespace stator::devices
