#include "stator/tmcl/sessions/reply.hpp"

#include <algorithm>

namespace stator::tmcl {

namespace {

Telegram encode_version_text(std::string_view text, std::uint8_t host_address) {
  Telegram telegram;
  telegram.fill(std::byte{' '});
  telegram[0] = std::byte{host_address};
  const std::size_t length = std::min(text.size(), telegram.size() - 1);
  for (std::size_t i = 0; i < length; ++i) {
    telegram[i + 1] = static_cast<std::byte>(text[i]);
  }
  return telegram;
}

}  // namespace

Telegram encode_reply(const HostAnswer& answer, const Request& request, std::uint8_t host_address,
                      std::string_view version_text) {
  switch (answer.form) {
    case ReplyForm::version_text:
      return encode_version_text(version_text, host_address);
    case ReplyForm::instruction:
      return encode(Request{.address = host_address,
                            .command = answer.instruction.command,
                            .type = answer.instruction.type,
                            .motor = answer.instruction.motor,
                            .value = answer.instruction.value});
    case ReplyForm::normal:
    case ReplyForm::none:
      break;
  }
  return encode(Reply{.host_address = host_address,
                      .module_address = request.address,
                      .status = answer.status,
                      .command = request.command,
                      .value = answer.value});
}

}  // namespace stator::tmcl
