#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <optional>

namespace stator::rack {

/// A bounded queue between two threads that never wait for each other: one puts in, one takes out.
/// Each side may change its thread if something else orders the accesses, as a mutex does.
template <typename T, std::size_t Capacity>
class HandOverQueue {
 public:
  /// False: no room.
  bool push(const T& item) {
    const std::size_t at = pushed_.load(std::memory_order_relaxed);
    if (at - popped_.load(std::memory_order_acquire) == Capacity) {
      return false;
    }
    items_[at % Capacity] = item;
    pushed_.store(at + 1, std::memory_order_release);
    return true;
  }
  [[nodiscard]] bool empty() const {
    return popped_.load(std::memory_order_relaxed) == pushed_.load(std::memory_order_acquire);
  }
  /// The oldest item, for the side that takes out; only while the queue is not empty.
  [[nodiscard]] T& front() { return items_[popped_.load(std::memory_order_relaxed) % Capacity]; }
  void pop() {
    popped_.store(popped_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }
  std::optional<T> take() {
    if (empty()) {
      return std::nullopt;
    }
    const T item = front();
    pop();
    return item;
  }

 private:
  static_assert((Capacity & (Capacity - 1)) == 0, "indices run over at a power of two");
  std::array<T, Capacity> items_{};
  std::atomic<std::size_t> pushed_{0};
  std::atomic<std::size_t> popped_{0};
};

}  // namespace stator::rack
