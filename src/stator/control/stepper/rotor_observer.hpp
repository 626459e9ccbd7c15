#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"

namespace stator::control {

/// How counts of an incremental encoder on the motor shaft relate to the motor.
struct EncoderScale {
  std::int64_t counts_per_revolution = 1;      ///< after quadrature evaluation
  std::int64_t steps_per_revolution = 51'200;  ///< 1/256 full steps: 256 for 90 degree electrical
  bool reversed = false;                       ///< counts down when the motor turns forward

  friend bool operator==(const EncoderScale&, const EncoderScale&) = default;
};

/// Where the rotor is and how fast, from encoder counts, in 1/256 full steps of the motor's own
/// coordinate. Whole revolutions are carried in integers, so nothing drifts.
class RotorObserver {
 public:
  /// Takes `scale` from now on; the rotor stays where it is.
  void set_scale(const EncoderScale& scale);
  /// Names the position at which the encoder shows `count`; velocity starts at 0.
  void place(std::int64_t position, std::int64_t count);
  /// Moves the position by `offset` without moving the encoder.
  void shift(std::int64_t offset) { base_ += offset; }
  /// Takes the encoder's count after `duration` (the same in most calls).
  void advance(std::int64_t count, base::SimDuration duration);

  /// The position is base() + within(); |within()| is at most a revolution.
  [[nodiscard]] std::int64_t base() const { return base_; }
  [[nodiscard]] double within() const { return within_; }
  /// 1/256 full steps per second: the mean with a time constant of 1 ms, and exactly 0 when no
  /// count has come for 20 ms.
  [[nodiscard]] double velocity() const { return velocity_; }
  /// The same with a time constant of 0.25 ms: noisy, but in time to damp a rotor's swing.
  [[nodiscard]] double quick_velocity() const { return quick_velocity_; }
  /// Way in one step of the duration last passed, at the present velocity.
  [[nodiscard]] double way_per_step() const { return velocity_ * seconds_; }
  /// Position of count 0 with the present scale, rounded.
  [[nodiscard]] std::int64_t position_of_count_zero() const;

 private:
  void set_duration(base::SimDuration duration);

  EncoderScale scale_;
  double steps_per_count_ = 51'200.0;
  std::int64_t signed_steps_per_revolution_ = 51'200;
  base::SimDuration duration_;
  double seconds_ = 0.0;
  double steps_per_second_ = 0.0;  ///< that one count in one step means
  double smoothing_ = 1.0;
  double quick_smoothing_ = 1.0;
  int still_limit_ = 0;

  std::int64_t base_count_ = 0;
  std::int64_t base_ = 0;
  double within_ = 0.0;
  std::int64_t count_ = 0;
  double velocity_ = 0.0;
  double quick_velocity_ = 0.0;
  int still_ = 0;  ///< steps without a count
};

}  // namespace stator::control
