#pragma once

#include <algorithm>
#include <vector>

namespace stator::rack {

/// What is wanted of one input of a device: events, programs and wires set it, faults hold it. The
/// newest hold that lasts is in force, without one what was set last, at first 0.
class HeldInput {
 public:
  /// Notes what the input is to be. False: a hold is in force, and the value comes after it.
  bool set(double value) {
    set_ = value;
    return holds_.empty();
  }
  /// `owner` wants `value` until it releases the input. False: a newer hold is in force.
  bool hold(const void* owner, double value) {
    const auto known = std::ranges::find(holds_, owner, &Hold::owner);
    if (known == holds_.end()) {
      holds_.push_back({owner, value});
      return true;
    }
    known->value = value;
    return known + 1 == holds_.end();
  }
  /// False: nothing changes, for a newer hold is in force or there was none of `owner`.
  bool release(const void* owner) {
    const auto known = std::ranges::find(holds_, owner, &Hold::owner);
    if (known == holds_.end()) {
      return false;
    }
    const bool in_force = known + 1 == holds_.end();
    holds_.erase(known);
    return in_force;
  }
  /// What is in force.
  [[nodiscard]] double value() const { return holds_.empty() ? set_ : holds_.back().value; }

 private:
  struct Hold {
    const void* owner = nullptr;
    double value = 0.0;
  };
  double set_ = 0.0;
  std::vector<Hold> holds_;  ///< the newest last
};

}  // namespace stator::rack
