#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/control/microstep_position.hpp"

namespace stator::control {

/// What the set-point is doing; chooses run, boost or standby current (TMCM-3315: 2003h, 204Eh,
/// 2004h).
enum class RampPhase : std::uint8_t { standstill, accelerating, constant_velocity, decelerating };

/// Set-point of one moment. Units: microsteps, microsteps per second (pps), pps per second.
struct MotionState {
  MicrostepPosition position;
  double velocity = 0.0;
  double acceleration = 0.0;
};

/// A stretch of constant jerk in closed form, t seconds after it began and with
/// tau = t - reference_time:
///   acceleration(t) = acceleration + jerk * tau
///   velocity = reference_velocity + acceleration * tau + jerk * tau^2 / 2
///   position = reference_position + reference_velocity * tau + acceleration * tau^2 / 2
///              + jerk * tau^3 / 6
/// A stretch that ends on a target takes its end as reference, so arrival is exact by construction.
struct MotionSegment {
  double duration = 0.0;        ///< s; for the last segment of a plan see MotionPlan
  double reference_time = 0.0;  ///< s after the begin of the segment
  MicrostepPosition reference_position;
  double reference_velocity = 0.0;  ///< pps
  double acceleration = 0.0;        ///< pps/s, at the reference
  double jerk = 0.0;                ///< pps/s^2
  RampPhase phase = RampPhase::standstill;

  [[nodiscard]] constexpr MotionState at(double time) const {
    // Horner's scheme for the cubic and its derivatives; this is the whole cost of a ramp's tick.
    const double tau = time - reference_time;
    const double bend = (1.0 / 6.0) * jerk * tau;
    const double slope = 0.5 * acceleration + bend;
    const double mean_velocity = reference_velocity + slope * tau;
    const double rise = slope + bend;
    return {displaced(reference_position, mean_velocity * tau), mean_velocity + rise * tau,
            2.0 * (rise + bend)};
  }
};

/// What a profile planner makes and RampGenerator plays: segments in order of time. Every complete
/// plan ends with rest() or cruise(), which last for ever, so playing one never runs off its end.
/// The duration of this last segment is the age at which its reference is moved up to the present,
/// for a double must not hold all that an endless cruise has covered.
class MotionPlan {
 public:
  /// Enough for "stop, return" with bows: turn, end of gaining speed, 4 to brake; 3 to gain speed,
  /// cruise, 3 to brake, rest.
  static constexpr std::size_t kCapacity = 14;

  MotionPlan() = default;
  MotionPlan(const MotionPlan& other) { *this = other; }
  /// Copies the segments in use only: the capacity is many times what most plans need.
  MotionPlan& operator=(const MotionPlan& other) {
    if (this == &other) {
      return *this;
    }
    std::copy_n(other.segments_.begin(), other.size_, segments_.begin());
    size_ = other.size_;
    return *this;
  }
  ~MotionPlan() = default;

  [[nodiscard]] constexpr std::size_t size() const { return size_; }
  [[nodiscard]] constexpr const MotionSegment& operator[](std::size_t i) const {
    return segments_[i];
  }
  constexpr MotionSegment& operator[](std::size_t i) { return segments_[i]; }

  /// Appends a segment; one without duration is left out.
  constexpr void append(const MotionSegment& segment) {
    if (segment.duration > 0.0) {
      segments_[size_++] = segment;
    }
  }
  /// Ends the plan: stand at `position` from here on.
  void rest(const MicrostepPosition& position);
  /// Ends the plan: keep `velocity` from `position` on.
  void cruise(const MicrostepPosition& position, double velocity);
  /// Time until the last segment begins, s.
  [[nodiscard]] double duration() const;

 private:
  std::array<MotionSegment, kCapacity> segments_{};
  std::size_t size_ = 0;
};

}  // namespace stator::control
