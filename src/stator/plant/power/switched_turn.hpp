#pragma once

#include <optional>

#include "stator/plant/power/inverter.hpp"
#include "stator/plant/power/supply.hpp"
#include "stator/plant/power/windings.hpp"

namespace stator::plant {

/// switch_period() of a three-phase motor that turns freely, three times as fast; nothing where it
/// does anything else, and state and supply are as before. Returns the energy (J) the bridge took.
///
/// Between edges the flux linkage phi = i + k z (HeldVoltage) is solved exactly for a rotor that
/// turns as speed and torque at the begin of the period promise. Its speed at the end follows from
/// the integral of the quadrature current over all stretches; by how much the ripple of the torque
/// turned it otherwise than promised, less than 1e-5 rad, is made good at the end.
std::optional<double> turn_switched(ThreePhaseWinding& winding, const InverterParameters& inverter,
                                    Supply& supply, SupplyState& supply_state,
                                    const ThreePhaseWinding::Values& duty, const ShaftInput& shaft,
                                    bool chopper_on, double period);

}  // namespace stator::plant
