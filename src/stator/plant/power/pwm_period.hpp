#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "stator/plant/power/inverter.hpp"

namespace stator::plant {

/// What half bridges do within one centre-aligned PWM period of T seconds: all begin low, half
/// bridge k goes high at T/2 (1 - d_k) and low again at T/2 (1 + d_k).
///
/// During the dead time td after either command both transistors are off and the current chooses:
/// one that flows into the motor keeps the node a diode's drop below ground, one that flows out of
/// it a drop above the supply. So a rising edge comes late for a current into the motor and a
/// falling one for a current out of it. The diode's drop Vd counts as a shift of the edge by td Vd
/// / Vb, which takes the same voltage over time. A current that reverses within a dead time is
/// taken to have had its sign from the begin; edges that would lie outside the period fall on its
/// border.
template <std::size_t kBridges>
class PwmPeriod {
 public:
  using Values = std::array<double, kBridges>;

  PwmPeriod(const InverterParameters& inverter, double supply_voltage, const Values& duty,
            double period)
      : period_(period) {
    const double shift = inverter.dead_time * inverter.diode_drop / supply_voltage;
    early_ = inverter.dead_time > 0.0 ? -shift : 0.0;
    late_ = inverter.dead_time + shift;
    for (std::size_t k = 0; k < kBridges; ++k) {
      const double half = 0.5 * period * duty[k];
      const bool switches = duty[k] > 0.0 && duty[k] < 1.0;
      next_[k] = switches ? 0.5 * period - half : kNever;
      falls_[k] = switches ? 0.5 * period + half : kNever;
      high_[k] = duty[k] >= 1.0 ? 1.0 : 0.0;
      high_sides_ |= duty[k] >= 1.0 ? 1U << k : 0U;
    }
  }

  [[nodiscard]] double time() const { return time_; }  ///< s since the begin
  /// Whether each half bridge connects its terminal to the supply (1) or to ground (0).
  [[nodiscard]] const Values& high() const { return high_; }
  /// The same as bits: bit k for half bridge k.
  [[nodiscard]] unsigned high_sides() const { return high_sides_; }
  [[nodiscard]] bool over() const { return time_ >= period_; }

  /// The time until the next edge, s, where the half bridges carry `current` (A, positive into the
  /// motor), which changes by `slope` (A/s). pass() makes that edge happen.
  double until_edge(const Values& current, const Values& slope) {
    double soonest = period_;
    edge_ = kBridges;
    for (std::size_t k = 0; k < kBridges; ++k) {
      const double then = current[k] + slope[k] * (next_[k] - time_);
      const bool against = (then > 0.0) == (high_[k] == 0.0);
      const double at = next_[k] + (against ? late_ : early_);
      edge_ = at < soonest ? k : edge_;
      soonest = at < soonest ? at : soonest;
    }
    next_time_ = soonest < time_ ? time_ : soonest;
    return next_time_ - time_;
  }
  /// Shifts all edges as dead time does for currents that keep the sign of `current` for the whole
  /// period; until_edge() without currents then finds them.
  void keep_signs(const Values& current) {
    for (std::size_t k = 0; k < kBridges; ++k) {
      const bool into = current[k] > 0.0;
      const double rise = next_[k] + (into ? late_ : early_);
      const double fall = falls_[k] + (into ? early_ : late_);
      next_[k] = rise < 0.0 ? 0.0 : rise;
      falls_[k] = fall < next_[k] ? next_[k] : fall;
    }
  }
  /// The same where there is no dead time, or keep_signs() has dealt with it.
  double until_edge() {
    double soonest = period_;
    edge_ = kBridges;
    for (std::size_t k = 0; k < kBridges; ++k) {
      edge_ = next_[k] < soonest ? k : edge_;
      soonest = next_[k] < soonest ? next_[k] : soonest;
    }
    next_time_ = soonest;
    return next_time_ - time_;
  }
  /// Returns the half bridge that switched, kBridges at the end of the period.
  std::size_t pass() {
    time_ = next_time_;
    if (edge_ < kBridges) {
      next_[edge_] = falls_[edge_];
      falls_[edge_] = kNever;
      high_[edge_] = 1.0 - high_[edge_];
      high_sides_ ^= 1U << edge_;
    }
    return edge_;
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  double period_;
  double time_ = 0.0;
  double next_time_ = 0.0;
  double early_;
  double late_;
  std::size_t edge_ = kBridges;
  Values next_{};   ///< s; when each half bridge is told to switch next
  Values falls_{};  ///< s
  Values high_{};
  unsigned high_sides_ = 0;
};

}  // namespace stator::plant
