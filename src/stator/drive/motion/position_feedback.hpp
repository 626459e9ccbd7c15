#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/base/sim_time.hpp"

namespace stator::drive {

/// Turns the counts of an incremental encoder into microsteps and a velocity.
class PositionFeedback {
 public:
  /// `increments` counts correspond to `microsteps`; both for one revolution, not negative. 0
  /// increments count as 1. The position is scaled anew from the count, so it does not drift; only
  /// a new number of microsteps keeps it as it is: from here on each counts for another angle.
  void set_scale(std::int64_t increments, std::int64_t microsteps, bool reversed);
  /// Takes the count of this control period; the velocity is the mean over the last kWindow ones.
  void update(std::int64_t count, base::SimDuration period);
  /// Names the present position `microsteps`.
  void set_position(std::int64_t microsteps) { set_position_at(count_, microsteps); }
  /// Names the position at `count` of the encoder `microsteps`.
  void set_position_at(std::int64_t count, std::int64_t microsteps) {
    offset_ = microsteps - scaled(count);
  }

  /// Microsteps, rounded to the nearest.
  [[nodiscard]] std::int64_t position() const { return position_at(count_); }
  [[nodiscard]] std::int64_t position_at(std::int64_t count) const {
    return scaled(count) + offset_;
  }
  [[nodiscard]] double velocity() const { return velocity_; }  ///< pps

 private:
  static constexpr std::size_t kWindow = 16;

  [[nodiscard]] std::int64_t scaled(std::int64_t count) const;

  std::int64_t increments_ = 1;
  std::int64_t microsteps_ = 1;
  bool reversed_ = false;
  std::int64_t count_ = 0;
  std::int64_t offset_ = 0;
  double velocity_ = 0.0;
  std::array<std::int64_t, kWindow> history_{};  ///< counts, newest at next_ - 1
  std::size_t next_ = 0;
};

}  // namespace stator::drive
