#pragma once

#include <algorithm>
#include <vector>

#include "stator/base/sim_time.hpp"

namespace stator::board {

/// When each of a board's peripherals wants to be called next, side by side, with the earliest of
/// these moments at hand: a board asks for it several times at each event. Invariant: earliest_ is
/// not after any moment, and is one of them unless stale_.
class Calendar {
 public:
  /// At construction of the board only. Returns the new entry's number; its moment is never().
  std::size_t add() {
    moments_.push_back(base::SimTime::never());
    return moments_.size() - 1;
  }
  void set(std::size_t entry, base::SimTime moment) {
    stale_ = stale_ || moments_[entry] == earliest_;
    moments_[entry] = moment;
    if (moment <= earliest_) {
      earliest_ = moment;
      stale_ = false;
    }
  }
  [[nodiscard]] base::SimTime at(std::size_t entry) const { return moments_[entry]; }
  [[nodiscard]] std::size_t size() const { return moments_.size(); }
  [[nodiscard]] base::SimTime earliest() const {
    if (stale_) {
      earliest_ = base::SimTime::never();
      for (const base::SimTime moment : moments_) {
        earliest_ = std::min(earliest_, moment);
      }
      stale_ = false;
    }
    return earliest_;
  }

 private:
  std::vector<base::SimTime> moments_;
  mutable base::SimTime earliest_ = base::SimTime::never();
  mutable bool stale_ = false;
};

}  // namespace stator::board
