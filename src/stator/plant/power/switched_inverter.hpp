#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "stator/plant/power/inverter.hpp"
#include "stator/plant/power/pwm_period.hpp"
#include "stator/plant/power/supply.hpp"
#include "stator/plant/power/windings.hpp"

namespace stator::plant {

/// Lets one centre-aligned PWM period pass edge by edge: between edges the terminals stand at
/// ground or at the supply, whose capacitor gives and takes the current of that moment. Sampling
/// points are the begin and end of the period, in the middle of the time in which all terminals are
/// low, where the ripple of the currents is 0. Returns the energy (J) the bridge took.
template <typename Winding>
double switch_period(Winding& winding, const InverterParameters& inverter, Supply& supply,
                     SupplyState& state, const typename Winding::Values& duty,
                     const ShaftInput& shaft, bool chopper_on, double period) {
  using Values = typename Winding::Values;
  PwmPeriod<Winding::kBridges> pwm(inverter, std::max(state.voltage, Supply::kLowestVoltage), duty,
                                   period);
  const double loss_per_ampere = inverter.dead_time * inverter.diode_drop;
  double taken = 0.0;
  double lost = 0.0;  // J in diodes at the latest edge
  const auto terminals = [](const Values& high, double voltage) {
    Values result{};
    for (std::size_t k = 0; k < Winding::kBridges; ++k) {
      result[k] = high[k] * voltage;
    }
    return result;
  };
  while (!pwm.over()) {
    const Values current = winding.currents();
    double drawn = 0.0;
    for (std::size_t k = 0; k < Winding::kBridges; ++k) {
      drawn += pwm.high()[k] * current[k];
    }
    const double h = pwm.until_edge(current, winding.slopes(terminals(pwm.high(), state.voltage)));
    if (h > 0.0) {
      const Supply::Stretch stretch = supply.stretch(state, h);
      const double voltage = stretch.halfway(drawn);
      const double energy = winding.pass(terminals(pwm.high(), voltage), shaft, h) + lost;
      taken += energy;
      supply.flow(state, stretch, energy / (std::max(voltage, Supply::kLowestVoltage) * h),
                  chopper_on);
      lost = 0.0;
    }
    const std::size_t edge = pwm.pass();
    if (edge < Winding::kBridges) {
      lost += loss_per_ampere * std::fabs(winding.currents()[edge]);
    }
  }
  return taken;
}

}  // namespace stator::plant
