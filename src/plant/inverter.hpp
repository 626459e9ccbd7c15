#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "plant/two_body_thermal.hpp"

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

/// Of half bridges at `supply` volts with the currents `current` (A) in windings of `inductance`
/// (H), for a motor that is integrated in steps of `step` seconds. Within the ripple (Vb T / 8 L
/// either way) the current changes its sign each period and the drop cancels; an explicit step
/// bears no more than the resistance drop / ripple.
template <std::size_t kBridges>
[[nodiscard]] DeadTimeDrop<kBridges> dead_time_drop(const InverterParameters& inverter,
                                                    double supply,
                                                    const std::array<double, kBridges>& current,
                                                    double inductance, double step) {
  const double share = inverter.dead_time * inverter.pwm_frequency;
  const double by_diodes = 2.0 * share * inverter.diode_drop;
  const double drop = supply * share + by_diodes;
  const double by_supply = 1.0 / (8.0 * inductance * inverter.pwm_frequency);
  const double by_drop = 4.0 * step / inductance;
  const double share_of_ripple = 1.0 / std::max(supply * by_supply, drop * by_drop);
  DeadTimeDrop<kBridges> result;
  for (std::size_t k = 0; k < kBridges; ++k) {
    result.lost_power += by_diodes * std::fabs(current[k]);
    result.voltage[k] = drop * std::clamp(current[k] * share_of_ripple, -1.0, 1.0);
  }
  return result;
}

}  // namespace stator::plant
