#pragma once

#include <array>

#include "stator/plant/axes/servo_axis.hpp"

namespace stator::plant {

/// Duties that put (`direct`, `quadrature`) volts on the axes of the rotor in the middle of a step
/// of 50 us: what a commutator with an ideal angle sensor would do.
inline std::array<double, 3> commutated(const ServoAxis& axis, double direct, double quadrature) {
  const SynchronousMotorState& motor = axis.state().motor;
  const base::SineCosine z =
      rotated(motor.direction, 25e-6 * motor.speed * axis.parameters().motor.pole_pairs);
  const std::array<double, 3> phase = phase_values(
      {z.cosine * direct - z.sine * quadrature, z.sine * direct + z.cosine * quadrature});
  const double scale = 1.0 / axis.sensing().supply_voltage;
  return {0.5 + phase[0] * scale, 0.5 + phase[1] * scale, 0.5 + phase[2] * scale};
}

/// A QBL4208-61 on an ideal 24 V source, without cogging and friction: what formulas speak of.
inline ServoAxisParameters textbook_axis() {
  ServoAxisParameters parameters;
  parameters.supply = {};
  parameters.inverter.on_resistance = 0.0;
  parameters.motor.cogging = {};
  parameters.motor.viscous_friction = 0.0;
  parameters.motor.coulomb_friction = 0.0;
  parameters.motor.static_friction = 0.0;
  // So that resistance and flux stay what the formulas say.
  parameters.motor.resistance_coefficient = 0.0;
  parameters.motor.flux_coefficient = 0.0;
  return parameters;
}

}  // namespace stator::plant
