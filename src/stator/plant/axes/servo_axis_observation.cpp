// ServoAxis::observe(): everything that is to be seen of a servo axis, computed from its state.
#include "stator/plant/axes/servo_axis.hpp"

namespace stator::plant {

ServoAxisObservation ServoAxis::observe() const {
  const SynchronousMotorState& motor = state_.motor;
  const ShaftMechanics& shaft = motor_.shaft();
  const ShaftMechanics::Frozen frozen =
      shaft.freeze(motor.angle, state_.external_torque, !state_.brake.open);
  ServoAxisObservation seen;
  seen.shaft_revolutions = shaft.revolutions(motor.angle);
  seen.shaft_angle = seen.shaft_revolutions * base::kTwoPi;
  seen.electrical_angle = motor.angle.angle;
  seen.speed = motor.speed;
  seen.electromagnetic_torque = motor_.electromagnetic_torque(motor);
  seen.cogging_torque = motor_.cogging_torque(motor);
  seen.load_torque = frozen.steady_torque;
  if (shaft.depends_on_position()) {
    seen.load_torque += shaft.positional_torque(frozen, 0.0, motor.speed);
    seen.end_stop_torque =
        shaft.has_end_stops() ? shaft.end_stop_torque(frozen, 0.0, motor.speed) : 0.0;
  }
  seen.direct_current = motor.direct_current();
  seen.quadrature_current = motor.quadrature_current();
  seen.phase_current = phase_values(motor.current);
  seen.back_emf = motor_.back_emf(motor);
  seen.supply_voltage = state_.supply.voltage;
  seen.supply_power = state_.supply_power;
  seen.supplied_energy = state_.supplied_energy;
  seen.winding_temperature = state_.motor_temperature.inner;
  seen.housing_temperature = state_.motor_temperature.outer;
  seen.driver_temperature = state_.stage_temperature.inner;
  return seen;
}

}  // namespace stator::plant
