#pragma once

#include <array>
#include <cstddef>

namespace stator::can {

/// A first-in first-out buffer with room for `Capacity` items.
template <typename Item, std::size_t Capacity>
class BoundedQueue {
 public:
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] bool full() const { return count_ == Capacity; }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] const Item& front() const { return items_[first_]; }
  /// False: it was full, nothing happened.
  bool push(const Item& item) {
    if (full()) {
      return false;
    }
    items_[(first_ + count_) % Capacity] = item;
    ++count_;
    return true;
  }
  void pop() {
    first_ = (first_ + 1) % Capacity;
    --count_;
  }
  void clear() { count_ = 0; }

 private:
  std::array<Item, Capacity> items_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace stator::can
