#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/event.hpp"
#include "base/sim_time.hpp"
#include "canopen/non_volatile_memory.hpp"
#include "devices/tmcm_142/module.hpp"
#include "tmcl/firmware.hpp"

namespace stator::devices::tmcm_142 {

/// Brings what the module keeps without power to a memory that outlives the device: one image of
/// parameters and coordinates, one of the program.
///
/// Parameters: each cell in 4 bytes. Program: command, type, motor and 4 bytes of value for each,
/// up to the last that is not erased. Numbers are little endian.
class Eeprom {
 public:
  /// Changes are handed on in intervals of this length, for a program may write in every pass.
  static constexpr base::SimDuration kInterval{10'000'000};

  /// Both must outlive it.
  Eeprom(Module& module, tmcl::Firmware& firmware, base::EventReporter reporter)
      : module_(module), firmware_(firmware), reporter_(reporter) {}

  /// Takes over what `memory` holds, and keeps changes there from now on.
  void connect(canopen::NonVolatileMemory& memory);
  /// Hands on what has changed, if it is time; cheap if nothing has.
  void service(base::SimTime now) {
    if (memory_ != nullptr && now >= next_) {
      next_ = now + kInterval;
      hand_on();
    }
  }
  void hand_on();

 private:
  void restore_parameters();
  void restore_program();

  Module& module_;
  tmcl::Firmware& firmware_;
  base::EventReporter reporter_;
  canopen::NonVolatileMemory* memory_ = nullptr;
  base::SimTime next_;
  std::uint64_t parameter_writes_ = 0;  ///< as handed on
  std::uint64_t program_writes_ = 0;
  std::vector<std::int32_t> cells_;
  std::vector<std::byte> image_;
};

}  // namespace stator::devices::tmcm_142
