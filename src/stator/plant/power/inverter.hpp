#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "stator/plant/motors/two_body_thermal.hpp"

namespace stator::plant {

/// The half bridges of a power stage. The defaults are those of a 10 A stage with
/// N-channel transistors on a small board.
struct InverterParameters {
  double on_resistance = 0.01;    ///< ohm of a transistor
  double pwm_frequency = 100e3;   ///< Hz
  double dead_time = 0.0;         ///< s both transistors of a half bridge are off, less what
                                  ///< the stage compensates
  double diode_drop = 0.7;        ///< V
  double switching_share = 2e-3;  ///< time spent switching: W per V and A
  /// Transistors inside, board outside.
  ThermalParameters thermal{.inner_capacity = 0.5,
                            .outer_capacity = 10.0,
                            .inner_to_outer = 3.0,
                            .outer_to_ambient = 12.0};
};

/// What dead time takes from the terminals, averaged over a PWM period.
template <std::size_t kBridges>
struct DeadTimeDrop {
  std::array<double, kBridges> voltage{};  ///< V
  double lost_power = 0.0;                 ///< W in diodes
};

/// Half bridges at windings of `inductance` (H) of a motor that is integrated in steps of `step`
/// seconds. Within the ripple (Vb T / 8 L either way) the current changes its sign each period and
/// the drop cancels; an explicit step bears no more than the resistance drop / ripple.
class DeadTime {
 public:
  DeadTime(const InverterParameters& inverter, double inductance, double step)
      : share_(inverter.dead_time * inverter.pwm_frequency),
        by_diodes_(2.0 * share_ * inverter.diode_drop),
        ripple_by_supply_(1.0 / (8.0 * inductance * inverter.pwm_frequency)),
        ripple_by_drop_(4.0 * step / inductance) {}

  /// At `supply` volts with the currents `current` (A) into the terminals.
  template <std::size_t kBridges>
  [[nodiscard]] DeadTimeDrop<kBridges> drop(double supply,
                                            const std::array<double, kBridges>& current) const {
    const double drop = supply * share_ + by_diodes_;
    const double share_of_ripple =
        1.0 / std::max(supply * ripple_by_supply_, drop * ripple_by_drop_);
    DeadTimeDrop<kBridges> result;
    for (std::size_t k = 0; k < kBridges; ++k) {
      result.lost_power += by_diodes_ * std::fabs(current[k]);
      result.voltage[k] = drop * std::clamp(current[k] * share_of_ripple, -1.0, 1.0);
    }
    return result;
  }

  [[nodiscard]] double share() const { return share_; }                        ///< of a period
  [[nodiscard]] double by_diodes() const { return by_diodes_; }                ///< V
  [[nodiscard]] double ripple_by_supply() const { return ripple_by_supply_; }  ///< A/V
  [[nodiscard]] double ripple_by_drop() const { return ripple_by_drop_; }      ///< A/V

 private:
  double share_;
  double by_diodes_;
  double ripple_by_supply_;
  double ripple_by_drop_;
};

}  // namespace stator::plant
