// StallGuard2, the load measurement of a stepper driver (TMC262 data sheet §7), and its settings.
#pragma once

#include <array>
#include <cstdint>

#include "stator/base/axis_signals.hpp"

namespace stator::control {

struct StallGuardSettings {
  int threshold = 0;    ///< -63..63 (209Eh); higher: less sensitive, the value is larger
  bool filter = false;  ///< one measurement of four full steps instead of each (209Dh)
};

/// Load measurement of a driver chip (StallGuard2, TMC262 data sheet §7): how much of the motor's
/// EMF the load leaves unused,
///   SG = 100 per V * mean(E - Pconverted / I) + 8 * threshold,   0..1023,
/// taken over a full step. With the load angle d it is E (1 - sin d): in proportion to speed,
/// falling linearly with load to 0 at pull-out, where all EMF works against the current, and 0 for
/// a shaft that stands. Where the supply is too low to regulate the current there is nothing to
/// measure and the value goes to 0 with the share of time in which that is so.
class StallGuard {
 public:
  static constexpr double kCountsPerVolt = 100.0;
  static constexpr int kCountsPerThreshold = 8;
  static constexpr int kMaximum = 1023;

  /// Takes in one step in which the coils were to carry `target` (A) and the motor was to turn
  /// forward or not. True when a measurement is complete.
  bool advance(const StallGuardSettings& settings, const std::array<double, 2>& target,
               bool forward, const base::AxisSensing& sensing) {
    const int quadrant = quadrant_of(target);
    const bool complete = quadrant != quadrant_ && finish_full_step(settings, quadrant, forward);
    induced_ += sensing.induced_voltage;
    converted_ += sensing.converted_power;
    square_current_ += sensing.coil_current[0] * sensing.coil_current[0] +
                       sensing.coil_current[1] * sensing.coil_current[1];
    samples_ += 1.0;
    regulated_ += sensing.current_regulated ? 1.0 : 0.0;
    return complete;
  }
  /// The motor stands, or the chip cannot measure: value 0; the full step under way does not count.
  void reset() { *this = StallGuard(); }

  /// Latest measurement, 0..1023.
  [[nodiscard]] std::uint16_t value() const { return value_; }

  /// Quarter of the electrical period the target lies in; a full step leads from one to the next.
  [[nodiscard]] static int quadrant_of(const std::array<double, 2>& target) {
    return (target[0] < 0.0 ? 2 : 0) + ((target[0] < 0.0) != (target[1] < 0.0) ? 1 : 0);
  }

 private:
  bool finish_full_step(const StallGuardSettings& settings, int quadrant, bool forward);

  int quadrant_ = -1;   ///< none yet
  bool whole_ = false;  ///< the full step under way was seen from its begin
  double induced_ = 0.0;
  double converted_ = 0.0;
  double square_current_ = 0.0;
  double samples_ = 0.0;
  double regulated_ = 0.0;

  double filtered_ = 0.0;  ///< sum of the full steps of a filtered measurement
  int filtered_steps_ = 0;
  std::uint16_t value_ = 0;
};

}  // namespace stator::control
