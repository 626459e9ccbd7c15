#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "stator/link/ethernet/ethernet_link.hpp"

namespace stator::link {

/// The counters behind LinkStatistics: each is written by one thread and read by any, so plain
/// loads and stores suffice and no bus lock is paid per frame.
class LinkCounters {
 public:
  void count_received(std::size_t bytes) {
    add(frames_received_, 1);
    add(bytes_received_, bytes);
  }
  void count_sent(std::size_t bytes) {
    add(frames_sent_, 1);
    add(bytes_sent_, bytes);
  }
  void count_send_error() { add(send_errors_, 1); }

  /// What was counted; `frames_dropped` is the kernel's knowledge and stays 0 here.
  [[nodiscard]] LinkStatistics snapshot() const {
    LinkStatistics statistics;
    statistics.frames_received = frames_received_.load(std::memory_order_relaxed);
    statistics.bytes_received = bytes_received_.load(std::memory_order_relaxed);
    statistics.frames_sent = frames_sent_.load(std::memory_order_relaxed);
    statistics.bytes_sent = bytes_sent_.load(std::memory_order_relaxed);
    statistics.send_errors = send_errors_.load(std::memory_order_relaxed);
    return statistics;
  }

 private:
  using Counter = std::atomic<std::uint64_t>;
  static void add(Counter& counter, std::uint64_t amount) {
    counter.store(counter.load(std::memory_order_relaxed) + amount, std::memory_order_relaxed);
  }

  Counter frames_received_ = 0;
  Counter bytes_received_ = 0;
  Counter frames_sent_ = 0;
  Counter bytes_sent_ = 0;
  Counter send_errors_ = 0;
};

}  // namespace stator::link
