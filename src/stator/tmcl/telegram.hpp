#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace stator::tmcl {

// Binary TMCL as it is sent over RS-232, RS-485, USB and TCP: nine bytes in each direction, values
// big-endian, the last byte the sum of the eight before it.

inline constexpr std::size_t kTelegramLength = 9;
using Telegram = std::array<std::byte, kTelegramLength>;

/// What a module answers in the third byte of a reply.
enum class Status : std::uint8_t {
  wrong_checksum = 1,
  invalid_command = 2,
  wrong_type = 3,
  invalid_value = 4,
  eeprom_locked = 5,
  command_not_available = 6,
  success = 100,
  loaded_into_eeprom = 101,
  target_reached = 128,  ///< only in the second reply to command 138
};
/// In words: "invalid value"; "unknown status" for a number that is none.
[[nodiscard]] std::string_view status_text(Status status);

/// From a host to a module.
struct Request {
  std::uint8_t address = 1;  ///< of the module
  std::uint8_t command = 0;
  std::uint8_t type = 0;
  std::uint8_t motor = 0;  ///< or bank
  std::int32_t value = 0;

  friend bool operator==(const Request&, const Request&) = default;
};

/// From a module to its host.
struct Reply {
  std::uint8_t host_address = 2;
  std::uint8_t module_address = 1;
  Status status = Status::success;
  std::uint8_t command = 0;  ///< the one that is answered
  std::int32_t value = 0;

  friend bool operator==(const Reply&, const Reply&) = default;
};

[[nodiscard]] Telegram encode(const Request& request);
[[nodiscard]] Telegram encode(const Reply& reply);
/// The fields of a telegram, whatever its checksum.
[[nodiscard]] Request decode_request(const Telegram& telegram);
[[nodiscard]] Reply decode_reply(const Telegram& telegram);

/// Sum of the first eight bytes, modulo 256.
[[nodiscard]] std::uint8_t checksum(const Telegram& telegram);
[[nodiscard]] bool has_right_checksum(const Telegram& telegram);

}  // namespace stator::tmcl
