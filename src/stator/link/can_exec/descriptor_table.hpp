#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

namespace stator::link::can_exec {

/// Sockets of this process that the library takes care of, by descriptor. Descriptors made by dup()
/// share one.
template <typename Socket>
class DescriptorTable {
 public:
  /// Never destroyed, since programs close descriptors until the very end.
  static DescriptorTable& instance() {
    static auto* const table = new DescriptorTable;
    return *table;
  }

  /// Null if `descriptor` is none of them.
  [[nodiscard]] std::shared_ptr<Socket> find(int descriptor) {
    if (descriptor < 0 ||
        (descriptor < kQuick &&
         !known_[static_cast<std::size_t>(descriptor)].load(std::memory_order_relaxed))) {
      return nullptr;
    }
    const std::scoped_lock lock(mutex_);
    const auto found = sockets_.find(descriptor);
    return found == sockets_.end() ? nullptr : found->second;
  }
  void add(int descriptor, std::shared_ptr<Socket> socket) {
    const std::scoped_lock lock(mutex_);
    sockets_[descriptor] = std::move(socket);
    mark(descriptor, true);
  }
  void remove(int descriptor) {
    if (find(descriptor)) {
      const std::scoped_lock lock(mutex_);
      sockets_.erase(descriptor);
      mark(descriptor, false);
    }
  }
  /// Those from `first` to `last`.
  void remove(unsigned first, unsigned last) {
    const std::scoped_lock lock(mutex_);
    std::erase_if(sockets_, [&](const auto& each) {
      const auto descriptor = static_cast<unsigned>(each.first);
      const bool gone = descriptor >= first && descriptor <= last;
      if (gone) {
        mark(each.first, false);
      }
      return gone;
    });
  }
  /// `to` is a copy of `from`, whatever it was before.
  void share(int from, int to) {
    remove(to);
    if (auto socket = find(from)) {
      add(to, std::move(socket));
    }
  }

 private:
  static constexpr int kQuick = 65536;

  void mark(int descriptor, bool known) {
    if (descriptor < kQuick) {
      known_[static_cast<std::size_t>(descriptor)].store(known, std::memory_order_relaxed);
    }
  }

  std::mutex mutex_;
  std::map<int, std::shared_ptr<Socket>> sockets_;
  /// Lets all other descriptors pass without the lock.
  std::array<std::atomic<bool>, kQuick> known_{};
};

}  // namespace stator::link::can_exec
