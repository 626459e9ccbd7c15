#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "stator/ethercat/eoe/eoe_reassembly.hpp"

namespace stator::ethercat {

/// Ethernet frames waiting to be sent, oldest first, in memory taken at construction. When it is
/// full the oldest is dropped: protocols above repeat what is lost, and newer frames matter more.
class EthernetFrameQueue {
 public:
  explicit EthernetFrameQueue(std::size_t capacity) : frames_(capacity) {}

  /// Appends a frame of 1 to kMaximumEoeFrame bytes; false if the oldest had to go for it.
  bool push(std::span<const std::byte> frame) {
    const bool full = count_ == frames_.size();
    if (full) {
      drop_oldest();
    }
    Frame& slot = frames_[(oldest_ + count_) % frames_.size()];
    std::ranges::copy(frame, slot.bytes.begin());
    slot.length = frame.size();
    ++count_;
    return !full;
  }

  /// Moves the oldest frame into `buffer` (kMaximumEoeFrame bytes); its length, or 0 if none waits.
  std::size_t pop(std::span<std::byte> buffer) {
    if (count_ == 0) {
      return 0;
    }
    const Frame& frame = frames_[oldest_];
    const std::size_t length = frame.length;
    std::ranges::copy(std::span(frame.bytes).first(length), buffer.begin());
    drop_oldest();
    return length;
  }

  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] bool full() const { return count_ == frames_.size(); }
  void clear() { count_ = 0; }

 private:
  struct Frame {
    std::array<std::byte, kMaximumEoeFrame> bytes{};
    std::size_t length = 0;
  };

  void drop_oldest() {
    oldest_ = (oldest_ + 1) % frames_.size();
    --count_;
  }

  std::vector<Frame> frames_;
  std::size_t oldest_ = 0;
  std::size_t count_ = 0;
};

}  // namespace stator::ethercat
