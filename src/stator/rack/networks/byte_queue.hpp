#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace stator::rack {

/// Bytes that wait in their order, `Capacity` at most.
template <std::size_t Capacity>
class ByteQueue {
 public:
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t room() const { return Capacity - size_; }

  /// Returns how many of `bytes` found room, the first ones.
  std::size_t push(std::span<const std::byte> bytes) {
    const std::size_t length = std::min(bytes.size(), room());
    for (std::size_t i = 0; i < length; ++i) {
      bytes_[(first_ + size_++) % Capacity] = bytes[i];
    }
    return length;
  }
  /// Moves bytes into `buffer` and returns how many.
  std::size_t pop(std::span<std::byte> buffer) {
    const std::size_t length = std::min(buffer.size(), size_);
    for (std::size_t i = 0; i < length; ++i) {
      buffer[i] = bytes_[(first_ + i) % Capacity];
    }
    first_ = (first_ + length) % Capacity;
    size_ -= length;
    return length;
  }
  void clear() { size_ = 0; }

 private:
  std::array<std::byte, Capacity> bytes_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace stator::rack
