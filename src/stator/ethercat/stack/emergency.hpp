#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace stator::ethercat {

/// An emergency message (CiA 301 §7.2.7, ETG.1000.6 §5.6.4): eight bytes on the wire.
struct EmergencyMessage {
  std::uint16_t error_code = 0;
  std::uint8_t error_register = 0;
  std::array<std::uint8_t, 5> additional{};

  static constexpr std::size_t kSize = 8;
  void encode(std::span<std::byte> bytes) const;
};

/// Emergencies waiting for the mailbox, oldest first. When it is full the newest is dropped: the
/// first one tells the cause.
class EmergencyQueue {
 public:
  static constexpr std::size_t kCapacity = 16;

  /// False if the queue was full.
  bool push(const EmergencyMessage& message);
  /// The queue must not be empty.
  EmergencyMessage pop();
  [[nodiscard]] bool empty() const { return count_ == 0; }
  void clear() { count_ = 0; }

 private:
  std::array<EmergencyMessage, kCapacity> messages_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace stator::ethercat
