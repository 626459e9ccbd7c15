// Signals of a rack over time, kept in columns that NumPy looks at without a copy.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/product/device/signal.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/observe/signal_tap.hpp"

namespace stator::python {

/// Numbers that are appended; those that somebody looks at stay where they are.
class Column {
 public:
  /// The first `size` numbers, as long as somebody has them.
  struct Look {
    std::shared_ptr<const double[]> values;
    std::size_t size = 0;
  };

  void append(double value) {
    if (size_ == capacity_) {
      grow();
    }
    values_[size_++] = value;
  }
  void clear() { *this = {}; }
  [[nodiscard]] Look look() const { return {values_, size_}; }

 private:
  void grow();

  std::shared_ptr<double[]> values_;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

/// Samples of chosen signals of a rack from now on. For whoever holds the rack.
class SignalStore {
 public:
  /// Rows that may wait between two calls of take().
  static constexpr std::size_t kWaitingRows = 8192;

  /// Of `rack`, at `now`, every `period`; it must outlive the store.
  SignalStore(rack::Rack& rack, std::vector<product::Signal> signals, base::SimDuration period,
              base::SimTime now);
  SignalStore(const SignalStore&) = delete;
  SignalStore& operator=(const SignalStore&) = delete;
  ~SignalStore();

  /// Moves what was sampled into the columns.
  void take();
  /// Forgets all rows so far.
  void clear();

  [[nodiscard]] const std::vector<product::Signal>& signals() const { return tap_.signals(); }
  [[nodiscard]] base::SimDuration period() const { return tap_.period(); }
  /// Sampling instants, s.
  [[nodiscard]] Column::Look times() const { return times_.look(); }
  /// Of the signal with that number.
  [[nodiscard]] Column::Look values(std::size_t signal) const { return values_[signal].look(); }
  /// Rows lost because nobody called take() in time.
  [[nodiscard]] std::uint64_t lost() const { return tap_.lost(); }

 private:
  rack::Rack& rack_;
  rack::SignalTap tap_;
  Column times_;
  std::vector<Column> values_;
};

}  // namespace stator::python
