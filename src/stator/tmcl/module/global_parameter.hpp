#pragma once

#include <cstdint>

namespace stator::tmcl {

/// Numbers of the global parameters in bank 0 that the room itself obeys (TMCM-142 manual, 8.1);
/// other parameters are the module's business.
enum class GlobalParameter : std::uint8_t {
  serial_address = 66,
  ascii_mode = 67,
  can_reply_identifier = 70,
  can_identifier = 71,
  eeprom_lock = 73,
  telegram_pause = 75,
  serial_host_address = 76,
  auto_start = 77,
  code_protection = 81,
  can_secondary_identifier = 83,
  coordinate_storage = 84,
  application_status = 128,
  download_mode = 129,
  program_counter = 130,
  tick_timer = 132,
  random_number = 133,
};

inline constexpr std::uint8_t kConfigurationBank = 0;
inline constexpr std::uint8_t kUserVariableBank = 2;

/// What is written to GlobalParameter::eeprom_lock; it reads 1 when locked and 0 when not.
inline constexpr std::int32_t kLockEeprom = 1234;
inline constexpr std::int32_t kUnlockEeprom = 4321;

/// GlobalParameter::code_protection: bits, so that 3 is both.
inline constexpr std::uint32_t kProtectedFromReading = 1;
inline constexpr std::uint32_t kProtectedFromWriting = 2;

/// GlobalParameter::ascii_mode.
inline constexpr std::uint32_t kStartInAsciiMode = 1;
inline constexpr unsigned kEchoModeShift = 4;
inline constexpr std::uint32_t kEchoModeMask = 3;

}  // namespace stator::tmcl
