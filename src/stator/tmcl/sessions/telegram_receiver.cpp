#include "stator/tmcl/sessions/telegram_receiver.hpp"

namespace stator::tmcl {

std::optional<Telegram> TelegramReceiver::take(std::byte byte, base::SimTime now) {
  if (now - last_ > gap_) {
    length_ = 0;
  }
  last_ = now;
  telegram_[length_++] = byte;
  if (length_ < telegram_.size()) {
    return std::nullopt;
  }
  length_ = 0;
  return telegram_;
}

}  // namespace stator::tmcl
