#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"

namespace stator::ethercat {

/// What a status LED shows, coded as in registers 0x0138 and 0x0139 (TMC8461 datasheet "RUN LED
/// Override"): 0 off, 1..12 that many flashes, 13 blinking, 14 flickering, 15 on.
enum class LedCode : std::uint8_t {
  off = 0,
  single_flash = 1,
  double_flash = 2,
  blinking = 13,
  flickering = 14,
  on = 15,
};

/// What the RUN LED shows in the state of an AL status value (ETG.1300): Init off, Pre-Operational
/// blinking, Bootstrap flickering, Safe-Operational single flash, Operational on. Off for values
/// that are no state.
[[nodiscard]] LedCode run_led_code(std::uint16_t al_status);

/// What the controller knows of errors.
struct ErrorIndication {
  std::uint16_t al_status = 1;
  std::uint16_t al_status_code = 0;
  bool eeprom_not_loaded = false;
  bool host_watchdog_expired = false;
};

/// What the ERR LED shows (ETG.1300): on for a host that has died, flickering for an error while
/// booting, double flash for the process data watchdog, blinking for a refused configuration,
/// single flash for a state change by the device itself; off without an error.
[[nodiscard]] LedCode error_led_code(const ErrorIndication& indication);

/// True if an LED with this code is lit `since` the pattern began (ETG.1300: flickering 50 ms on,
/// 50 ms off; blinking 200 ms, 200 ms; n flashes of 200 ms with 200 ms between them, then 1 s off).
/// Patterns repeat; `since` is not negative.
[[nodiscard]] bool led_lit(LedCode code, base::SimDuration since);

}  // namespace stator::ethercat
