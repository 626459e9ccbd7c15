#pragma once

#include <cstdint>
#include <optional>

#include "stator/base/sim_time.hpp"

namespace stator::board {

/// A peripheral that wants to know how many steps came, not when each of them did.
class StepFollower {
 public:
  StepFollower() = default;
  StepFollower(const StepFollower&) = delete;
  StepFollower& operator=(const StepFollower&) = delete;
  virtual ~StepFollower() = default;

  /// The chip's generator runs, or has run since last time.
  virtual void steps_come(base::SimTime now) = 0;
  /// Falling edges step too: they have to be seen.
  [[nodiscard]] virtual bool needs_edges() const = 0;
};

/// What became of the steps since the last question.
struct StepCount {
  std::int64_t steps = 0;  ///< signed: negative with DIR high
  bool running = false;    ///< more may come at any time
};

}  // namespace stator::board
