#pragma once

#include "stator/base/sim_time.hpp"

namespace stator::board {

/// The moments at which a plant makes its steps: multiples of its period since power-on, so that
/// what wakes it at any moment does not shift them.
class PlantGrid {
 public:
  explicit PlantGrid(base::SimDuration period) : period_(period) {}

  [[nodiscard]] base::SimDuration period() const { return period_; }
  /// The first of these moments at or after `now`.
  [[nodiscard]] base::SimTime at_or_after(base::SimTime now) const {
    const std::int64_t n = period_.nanoseconds();
    return base::SimTime(base::SimDuration((now.nanoseconds() + n - 1) / n * n));
  }

 private:
  base::SimDuration period_;
};

}  // namespace stator::board
