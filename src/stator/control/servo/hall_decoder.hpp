#pragma once

#include <cstdint>

#include "stator/control/servo/electrical_angle.hpp"

namespace stator::control {

/// Angle and position from three hall sensors 120 electrical degrees apart. Sensor k is high while
/// the rotor's flux is within 90 degrees of phase k, so that forward the codes (bits 0, 1, 2 for
/// H1, H2, H3) are 001 011 010 110 100 101, in the middle of each 0, 60, .. 300 degrees.
///
/// The angle is the middle of the sixth of a turn the code names. With interpolation it moves
/// through it, from the edge on, with the velocity of the sixth before, if that was above the
/// threshold and in the same direction; it waits at the end of the sixth, and returns to its middle
/// when the shaft has become slower than the threshold.
///
/// 000, 111 and a change by more than one sixth are errors: the former keep the last angle, the
/// latter is counted as far as its direction is clear.
class HallDecoder {
 public:
  static constexpr int kStepsPerTurn = 6;

  /// `slowest` is the longest sixth of a turn, in periods, that still is interpolated.
  void configure(bool inverted, bool interpolated, std::uint32_t slowest);

  /// Takes the levels in period number `period` (modulo 2^32); true when the sixth has changed.
  bool step(std::uint8_t levels, std::uint32_t period) {
    return levels != levels_ && change(levels, period);
  }

  [[nodiscard]] ElectricalAngle angle(std::uint32_t period) const {
    return interpolating_ ? interpolated_angle(period) : middle_;
  }
  /// Angle of the edge last passed.
  [[nodiscard]] ElectricalAngle edge() const { return edge_; }
  /// Sixths of electrical turns since power-on.
  [[nodiscard]] std::int64_t position() const { return position_; }
  /// The present code is one of the six.
  [[nodiscard]] bool valid() const { return valid_; }
  [[nodiscard]] bool error() const { return error_; }
  /// An impossible code that lasts is an error again at once.
  void clear_error() { error_ = levels_ != kNothing && !valid_; }

 private:
  static constexpr std::uint8_t kNothing = 0xFF;

  bool change(std::uint8_t levels, std::uint32_t period);
  void enter(unsigned sector, std::uint32_t period);
  [[nodiscard]] ElectricalAngle interpolated_angle(std::uint32_t period) const;

  std::uint8_t levels_ = kNothing;
  std::uint8_t inversion_ = 0;
  bool interpolated_ = false;
  bool interpolating_ = false;
  bool placed_ = false;  ///< a valid code has come
  bool valid_ = false;
  bool error_ = false;
  bool forward_ = true;
  std::uint8_t sector_ = 0;
  std::uint32_t slowest_ = 0;
  std::uint32_t edge_period_ = 0;
  std::uint32_t rate_ = 0;  ///< angle per period, without sign
  ElectricalAngle edge_;
  ElectricalAngle middle_;
  std::int64_t position_ = 0;
};

}  // namespace stator::control
