#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/product/device/signal.hpp"

namespace stator::rack {

/// Samples chosen signals of a running rack for somebody who may be slow: rows wait in a ring of
/// fixed length, one that finds it full is lost and counted. Sampling instants are multiples of the
/// period in simulated time, so taps of the same period stop the rack once.
class SignalTap {
 public:
  /// Rows of `signals` every `period` (> 0), of which `capacity` (>= 1) wait at most.
  SignalTap(std::vector<product::Signal> signals, base::SimDuration period, std::size_t capacity);

  // For whoever holds the rack.

  /// Begins with the first sampling instant at `now` or later.
  void begin(base::SimTime now);
  [[nodiscard]] base::SimTime next_sample() const { return next_sample_; }
  /// Takes one row at `now` and moves next_sample() on.
  void sample(base::SimTime now);

  // For the one thread that reads.

  [[nodiscard]] const std::vector<product::Signal>& signals() const { return signals_; }
  [[nodiscard]] base::SimDuration period() const { return period_; }
  /// Rows that wait.
  [[nodiscard]] std::size_t size() const {
    return written_.load(std::memory_order_acquire) - read_.load(std::memory_order_relaxed);
  }
  /// Of the row that waits at `index` < size(), 0 the oldest.
  [[nodiscard]] base::SimTime time(std::size_t index) const { return times_[slot(index)]; }
  [[nodiscard]] std::span<const double> values(std::size_t index) const {
    return std::span(values_).subspan(slot(index) * signals_.size(), signals_.size());
  }
  /// Gives the oldest `rows` <= size() back.
  void release(std::size_t rows) {
    read_.store(read_.load(std::memory_order_relaxed) + rows, std::memory_order_release);
  }
  /// Rows lost because the ring was full.
  [[nodiscard]] std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  [[nodiscard]] std::size_t slot(std::size_t index) const {
    return (read_.load(std::memory_order_relaxed) + index) % times_.size();
  }

  std::vector<product::Signal> signals_;
  base::SimDuration period_;
  base::SimTime next_sample_ = base::SimTime::never();
  std::vector<base::SimTime> times_;
  std::vector<double> values_;  ///< row by row
  std::atomic<std::size_t> written_{0};
  std::atomic<std::size_t> read_{0};
  std::atomic<std::uint64_t> lost_{0};
};

}  // namespace stator::rack
