#pragma once

#include <cstdint>

namespace stator::control {

/// Velocity of an incremental signal by counts and time: the increments between two edges divided
/// by the time between the edges (the M/T method). Fast signals give the count of a window, slow
/// ones the interval of two edges. While no edge comes the velocity is at most one increment in the
/// time since the last one, and 0 after `still_limit`. An increment back is a signal standing on an
/// edge: velocity 0.
///
/// Resolution: with edges known to one period T and a window W, the larger of one increment per W
/// and the share T / W of the velocity, never worse than one increment per period.
class VelocityMeter {
 public:
  static constexpr std::uint32_t kStillLimit = 5000;  ///< periods: 0.25 s

  /// Forgets everything; the signal stands at `position` in `period`.
  void place(std::int64_t position, std::uint32_t period) {
    edge_position_ = position;
    edge_period_ = period;
    reference_position_ = position;
    reference_period_ = period;
    velocity_ = 0.0;
  }
  /// To be called once in every period, whose number counts modulo 2^32.
  void note(std::int64_t position, std::uint32_t period) {
    if (position != edge_position_) {
      edge_position_ = position;
      edge_period_ = period;
    }
  }
  /// Ends a window in `period`; increments per period.
  double measure(std::uint32_t period);
  [[nodiscard]] double velocity() const { return velocity_; }

 private:
  std::int64_t edge_position_ = 0;
  std::int64_t reference_position_ = 0;
  std::uint32_t edge_period_ = 0;
  std::uint32_t reference_period_ = 0;
  double velocity_ = 0.0;
  bool forward_ = true;  ///< the latest movement was
};

}  // namespace stator::control
