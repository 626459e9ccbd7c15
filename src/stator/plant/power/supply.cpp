#include "stator/plant/power/supply.hpp"

namespace stator::plant {

Supply::Supply(const SupplyParameters& parameters)
    : parameters_(parameters),
      inverse_capacitance_(parameters.capacitance > 0.0 ? 1.0 / parameters.capacitance : 0.0),
      source_conductance_(1.0 / parameters.source_resistance),
      chopper_conductance_(1.0 / parameters.chopper_resistance) {}

Supply::Share Supply::share(double seconds, bool conducts) const {
  // Resistances act over the whole step (implicit Euler), for source and capacitor may be faster
  // than it; the bridge's current is that of the step.
  const double share = seconds * inverse_capacitance_;
  const double blocked = 1.0 + (conducts ? share * chopper_conductance_ : 0.0);
  const double feed = share * source_conductance_;
  return {.seconds = seconds,
          .conducts = conducts,
          .of_current = share,
          .alone = 1.0 / blocked,
          .feed = feed,
          .supplied = 1.0 / (blocked + feed)};
}

void Supply::advance(SupplyState& state, double power, double seconds) const {
  if (ideal()) {
    state.voltage = state.source;
    return;
  }
  switch_chopper(state, false);
  draw(state, power, share(seconds, state.chopper_conducts));
}

}  // namespace stator::plant
