#include "stator/plant/axes/axis_faults.hpp"

#include <algorithm>

namespace stator::plant {

namespace {

/// N m; whatever turns a shaft, a blocked one stands.
constexpr double kBlockingTorque = 1e6;

/// F that stands for the capacitor of a power stage with an ideal supply.
constexpr double kStageCapacitance = 470e-6;

}  // namespace

void AxisFaultState::note_jam(const ShaftFaults& shaft, double revolutions) {
  jam_from = std::min({shaft.jam_from, shaft.jam_to, revolutions});
  jam_to = std::max({shaft.jam_from, shaft.jam_to, revolutions});
}

MechanicalLoad faulted(MechanicalLoad load, const ShaftFaults& faults,
                       const AxisFaultState& state) {
  load.inertia = std::max(load.inertia + faults.inertia, 0.0);
  load.viscous_friction += faults.viscous_friction;
  load.coulomb_friction += faults.jamming_torque;
  if (faults.brake == BrakeFault::closed) {
    load.coulomb_friction += load.brake_torque;
    load.brake_torque = 0.0;
  } else {
    load.coulomb_friction += faults.brake_drag;
    load.brake_torque = faults.brake == BrakeFault::open
                            ? 0.0
                            : std::max(load.brake_torque - faults.brake_drag, 0.0);
  }
  if (faults.jam == Jam::blocked) {
    load.coulomb_friction += kBlockingTorque;
  } else if (faults.jam == Jam::between) {
    load.end_stop_minimum = std::max(load.end_stop_minimum, state.jam_from);
    load.end_stop_maximum = std::min(load.end_stop_maximum, state.jam_to);
  }
  return load;
}

SupplyParameters faulted(SupplyParameters supply, const SupplyFaults& faults) {
  if (faults.resistance > 0.0) {
    if (supply.capacitance <= 0.0) {
      supply.capacitance = kStageCapacitance;
      supply.source_resistance = 0.0;
    }
    supply.source_resistance += faults.resistance;
  }
  return supply;
}

void feed(SupplyState& supply, bool ideal, const SupplyFaults& faults, double supply_voltage) {
  supply.source = std::max(supply_voltage + faults.offset, 0.0);
  if (ideal || (faults.offset < 0.0 && supply.voltage > supply.source)) {
    supply.voltage = supply.source;
  }
}

void feed(SupplyState& supply, bool ideal, const SupplyFaults& before, const SupplyFaults& faults,
          double supply_voltage) {
  feed(supply, ideal, faults, supply_voltage);
  if (faults.offset < before.offset) {
    supply.voltage = std::min(supply.voltage, supply.source);
  }
}

}  // namespace stator::plant
