#include "stator/tmcl/telegram.hpp"

namespace stator::tmcl {

namespace {

constexpr std::size_t kValue = 4;
constexpr std::size_t kChecksum = 8;

std::uint8_t byte_at(const Telegram& telegram, std::size_t offset) {
  return std::to_integer<std::uint8_t>(telegram[offset]);
}

Telegram encode(const std::array<std::uint8_t, 4>& head, std::int32_t value) {
  Telegram telegram{};
  for (std::size_t i = 0; i < head.size(); ++i) {
    telegram[i] = std::byte{head[i]};
  }
  const auto bits = static_cast<std::uint32_t>(value);
  for (std::size_t i = 0; i < 4; ++i) {
    telegram[kValue + i] = static_cast<std::byte>(bits >> (24 - 8 * i));
  }
  telegram[kChecksum] = std::byte{checksum(telegram)};
  return telegram;
}

std::int32_t value_of(const Telegram& telegram) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    bits = bits << 8U | byte_at(telegram, kValue + i);
  }
  return static_cast<std::int32_t>(bits);
}

}  // namespace

std::string_view status_text(Status status) {
  switch (status) {
    case Status::wrong_checksum:
      return "wrong checksum";
    case Status::invalid_command:
      return "invalid command";
    case Status::wrong_type:
      return "wrong type";
    case Status::invalid_value:
      return "invalid value";
    case Status::eeprom_locked:
      return "configuration EEPROM locked";
    case Status::command_not_available:
      return "command not available";
    case Status::success:
      return "success";
    case Status::loaded_into_eeprom:
      return "loaded into the program memory";
    case Status::target_reached:
      return "target reached";
  }
  return "unknown status";
}

Telegram encode(const Request& request) {
  return encode({request.address, request.command, request.type, request.motor}, request.value);
}

Telegram encode(const Reply& reply) {
  return encode({reply.host_address, reply.module_address, static_cast<std::uint8_t>(reply.status),
                 reply.command},
                reply.value);
}

Request decode_request(const Telegram& telegram) {
  return {.address = byte_at(telegram, 0),
          .command = byte_at(telegram, 1),
          .type = byte_at(telegram, 2),
          .motor = byte_at(telegram, 3),
          .value = value_of(telegram)};
}

Reply decode_reply(const Telegram& telegram) {
  return {.host_address = byte_at(telegram, 0),
          .module_address = byte_at(telegram, 1),
          .status = static_cast<Status>(byte_at(telegram, 2)),
          .command = byte_at(telegram, 3),
          .value = value_of(telegram)};
}

std::uint8_t checksum(const Telegram& telegram) {
  unsigned sum = 0;
  for (std::size_t i = 0; i < kChecksum; ++i) {
    sum += byte_at(telegram, i);
  }
  return static_cast<std::uint8_t>(sum);
}

bool has_right_checksum(const Telegram& telegram) {
  return byte_at(telegram, kChecksum) == checksum(telegram);
}

}  // namespace stator::tmcl
