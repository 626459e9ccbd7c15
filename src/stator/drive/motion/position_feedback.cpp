#include "stator/drive/motion/position_feedback.hpp"

namespace stator::drive {

void PositionFeedback::set_scale(std::int64_t increments, std::int64_t microsteps, bool reversed) {
  const std::int64_t present = position();
  const bool new_resolution = microsteps != microsteps_;
  increments_ = increments > 0 ? increments : 1;
  microsteps_ = microsteps;
  reversed_ = reversed;
  if (new_resolution) {
    set_position(present);
  }
}

void PositionFeedback::update(std::int64_t count, base::SimDuration period) {
  count_ = count;
  const std::int64_t oldest = history_[next_];
  history_[next_] = count;
  next_ = (next_ + 1) % kWindow;
  const double window = static_cast<double>(kWindow) * period.seconds();
  const double counts_per_second = static_cast<double>(count - oldest) / window;
  velocity_ = counts_per_second * static_cast<double>(microsteps_) /
              static_cast<double>(increments_) * (reversed_ ? -1.0 : 1.0);
}

std::int64_t PositionFeedback::scaled(std::int64_t count) const {
  // Whole revolutions apart from the rest: neither product leaves 64 bits.
  const std::int64_t forward = reversed_ ? -count : count;
  std::int64_t revolutions = forward / increments_;
  std::int64_t rest = forward % increments_;
  if (rest < 0) {
    rest += increments_;
    --revolutions;
  }
  return revolutions * microsteps_ + (rest * microsteps_ + increments_ / 2) / increments_;
}

}  // namespace stator::drive
