#pragma once

#include <cstdint>

#include "stator/base/random.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/tmcl/interpreter/registers.hpp"

namespace stator::tmcl {

/// Of the stand-alone program, as command 135 and global parameter 128 number it.
enum class ApplicationStatus : std::uint8_t { stop = 0, run = 1, step = 2, reset = 3 };

/// What commands and the interpreter share, without the program and without what the module holds.
struct FirmwareState {
  Registers registers;
  ApplicationStatus application = ApplicationStatus::stop;
  /// Of the instruction that is executed or comes next (A69).
  std::uint16_t program_counter = 0;
  bool download = false;
  std::uint16_t download_address = 0;
  /// A command or instruction has written to the EEPROM, and its outcome was not taken yet.
  bool writing = false;
  /// The tick timer is the milliseconds since `tick_origin` plus `tick_preset`, modulo 2^32.
  base::SimTime tick_origin;
  std::int32_t tick_preset = 0;
  base::Random random{0};

  [[nodiscard]] std::int32_t tick_timer(base::SimTime now) const {
    const std::int64_t milliseconds = (now - tick_origin).nanoseconds() / 1'000'000;
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(tick_preset) +
                                     static_cast<std::uint32_t>(milliseconds));
  }
  void preset_tick_timer(std::int32_t value, base::SimTime now) {
    tick_origin = now;
    tick_preset = value;
  }
  /// 0 to 2^31 - 1, a new one each time (A70).
  [[nodiscard]] std::int32_t next_random_number() {
    return static_cast<std::int32_t>(random.next() >> 33);
  }
};

}  // namespace stator::tmcl
