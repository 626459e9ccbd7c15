#include "plant/supply.hpp"

#include <algorithm>

namespace stator::plant {

namespace {

/// V at which a bridge that still wants power gets what the capacitor can give, not an infinite
/// current.
constexpr double kLowestVoltage = 1.0;

}  // namespace

void Supply::advance(SupplyState& state, double power, double seconds) const {
  if (ideal()) {
    state.voltage = state.source;
    return;
  }
  if (state.voltage >= parameters_.chopper_voltage) {
    state.chopper_conducts = true;
  } else if (state.voltage < parameters_.chopper_voltage - parameters_.chopper_hysteresis) {
    state.chopper_conducts = false;
  }
  const double taken = power / std::max(state.voltage, kLowestVoltage);
  // Resistances act over the whole step (implicit Euler), for source and capacitor may be faster
  // than it; the bridge's current is that of the step.
  double conductance = state.chopper_conducts ? 1.0 / parameters_.chopper_resistance : 0.0;
  double current = -taken;
  const double share = seconds / parameters_.capacitance;
  const double alone = (state.voltage + share * current) / (1.0 + share * conductance);
  if (alone < state.source) {
    conductance += 1.0 / parameters_.source_resistance;
    current += state.source / parameters_.source_resistance;
  }
  state.voltage = (state.voltage + share * current) / (1.0 + share * conductance);
  state.voltage = std::max(state.voltage, 0.0);
}

}  // namespace stator::plant
