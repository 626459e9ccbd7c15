#include "stator/ethercat/stack/emergency.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"

namespace stator::ethercat {

void EmergencyMessage::encode(std::span<std::byte> bytes) const {
  base::store_le(bytes, 0, error_code);
  bytes[2] = static_cast<std::byte>(error_register);
  std::ranges::copy(std::as_bytes(std::span(additional)), bytes.begin() + 3);
}

bool EmergencyQueue::push(const EmergencyMessage& message) {
  if (count_ == kCapacity) {
    return false;
  }
  messages_[(first_ + count_) % kCapacity] = message;
  ++count_;
  return true;
}

EmergencyMessage EmergencyQueue::pop() {
  const EmergencyMessage message = messages_[first_];
  first_ = (first_ + 1) % kCapacity;
  --count_;
  return message;
}

}  // namespace stator::ethercat
