#include "plant/supply.hpp"

#include <algorithm>

namespace stator::plant {

namespace {

/// V at which a bridge that still wants power gets what the capacitor can give, not an infinite
/// current.
constexpr double kLowestVoltage = 1.0;

}  // namespace

Supply::Supply(const SupplyParameters& parameters)
    : parameters_(parameters),
      inverse_capacitance_(parameters.capacitance > 0.0 ? 1.0 / parameters.capacitance : 0.0),
      source_conductance_(1.0 / parameters.source_resistance),
      chopper_conductance_(1.0 / parameters.chopper_resistance) {}

void Supply::advance(SupplyState& state, double power, double seconds) const {
  draw(state, power / std::max(state.voltage, kLowestVoltage), seconds, false);
}

void Supply::draw(SupplyState& state, double current, double seconds, bool chopper_on) const {
  if (ideal()) {
    state.voltage = state.source;
    return;
  }
  if (state.voltage >= parameters_.chopper_voltage) {
    state.chopper_by_itself = true;
  } else if (state.voltage < parameters_.chopper_voltage - parameters_.chopper_hysteresis) {
    state.chopper_by_itself = false;
  }
  state.chopper_conducts = state.chopper_by_itself || chopper_on;
  // Resistances act over the whole step (implicit Euler), for source and capacitor may be faster
  // than it; the bridge's current is that of the step.
  const double share = seconds * inverse_capacitance_;
  const double conductance = state.chopper_conducts ? chopper_conductance_ : 0.0;
  const double charge = state.voltage - share * current;
  // Without the source the voltage would end above it: its diode blocks.
  const double blocked = 1.0 + share * conductance;
  const double feed = share * source_conductance_;
  // Reciprocals, for they do not depend on the voltage and hence are known early.
  const double alone = charge * (1.0 / blocked);
  const double supplied = (charge + feed * state.source) * (1.0 / (blocked + feed));
  state.voltage = std::max(alone < state.source ? supplied : alone, 0.0);
}

}  // namespace stator::plant
