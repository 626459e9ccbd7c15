#pragma once

#include "stator/tmcl/interpreter/firmware.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tmcl {

/// The nine bytes of the reply to `request`, in the form that `answer` asks for; ReplyForm::none
/// has none. Version text: host address and eight characters, without a checksum (L5185-L5195). A
/// cell of the program memory: host address, the seven bytes of the instruction, checksum (A88).
[[nodiscard]] Telegram encode_reply(const HostAnswer& answer, const Request& request,
                                    std::uint8_t host_address, std::string_view version_text);

}  // namespace stator::tmcl
