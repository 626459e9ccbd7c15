#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"

namespace stator::tmcl {

/// Keeps what commands write to the EEPROM (parameters, coordinates, the program) without supply.
/// The processor waits for that: meanwhile no command of a host and no instruction of a program is
/// executed, and the reply to the command that wrote comes afterwards.
class EepromKeeper {
 public:
  enum class Outcome : std::uint8_t {
    kept,    ///< or there was nothing to keep, or it is tried again
    busy,    ///< it is being written
    failed,  ///< it could not be written: what the EEPROM held before is there again
  };

  EepromKeeper() = default;
  EepromKeeper(const EepromKeeper&) = delete;
  EepromKeeper& operator=(const EepromKeeper&) = delete;
  virtual ~EepromKeeper() = default;

  /// A command has been executed, and what it wrote to the EEPROM is to be kept. `refusable`: if
  /// that fails, the host that gave the command is told, so that it then counts as not executed;
  /// otherwise what it wrote stays and is tried again. Not to be called while busy; costs little if
  /// nothing was written.
  [[nodiscard]] virtual Outcome keep(bool refusable, base::SimTime now) = 0;
  /// What has become of it. Busy also while something is written that no command asked for.
  [[nodiscard]] virtual Outcome outcome() const = 0;
};

}  // namespace stator::tmcl
