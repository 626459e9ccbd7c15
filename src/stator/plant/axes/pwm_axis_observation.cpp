#include <algorithm>

#include "stator/plant/axes/pwm_axis.hpp"

namespace stator::plant {

namespace {

/// Torque of load, stops and outside, N m.
double load_torque(const ShaftMechanics& shaft, const ElectricalAngle& angle, double speed,
                   const ShaftInput& input) {
  const ShaftMechanics::Frozen frozen = shaft.freeze(angle, input.torque, input.brake_engaged);
  return frozen.steady_torque +
         (shaft.depends_on_position() ? shaft.positional_torque(frozen, 0.0, speed) : 0.0);
}

void observe_motor(const ThreePhaseWinding& winding, const ShaftInput& input,
                   PwmAxisObservation& seen) {
  const SynchronousMotorState& state = winding.state();
  seen.cogging_torque = winding.motor().cogging_torque(state);
  seen.load_torque = load_torque(winding.motor().shaft(), state.angle, state.speed, input);
  seen.direct_current = state.direct_current();
  seen.quadrature_current = state.quadrature_current();
}

void observe_motor(const TwoPhaseWinding& winding, const ShaftInput& input,
                   PwmAxisObservation& seen) {
  const HybridStepperState& state = winding.state();
  const base::SineCosine z = winding.direction();
  seen.cogging_torque = -winding.motor().detent_torque(state);
  seen.load_torque = winding.motor().load_torque(state, input.torque);
  seen.direct_current = z.cosine * state.current[0] + z.sine * state.current[1];
  seen.quadrature_current = z.cosine * state.current[1] - z.sine * state.current[0];
}

void observe_motor(const DcWinding& winding, const ShaftInput& input, PwmAxisObservation& seen) {
  const DcMotorState& state = winding.state();
  seen.load_torque = load_torque(winding.motor().shaft(), state.angle, state.speed, input);
  seen.quadrature_current = state.current;
}

}  // namespace

PwmAxisObservation PwmAxis::observe() const {
  PwmAxisObservation seen;
  seen.shaft_revolutions = revolutions();
  seen.shaft_angle = seen.shaft_revolutions * base::kTwoPi;
  seen.terminal_current = currents();
  std::visit(
      [&](const auto& winding) {
        seen.electrical_angle = winding.angle().angle;
        seen.speed = winding.speed();
        seen.electromagnetic_torque = winding.torque();
        observe_motor(winding, shaft_, seen);
      },
      winding_);
  seen.supply_voltage = supply_state_.voltage;
  seen.supply_power = period_seconds_ > 0.0 ? period_energy_ / period_seconds_ : 0.0;
  seen.supplied_energy = bridge_energy_;
  seen.winding_temperature = motor_temperature_.inner;
  seen.housing_temperature = motor_temperature_.outer;
  seen.driver_temperature = stage_temperature_.inner;
  seen.board_temperature = stage_temperature_.outer;
  return seen;
}

std::array<double, 4> PwmAxis::currents() const {
  std::array<double, 4> result{};
  std::visit(
      [&result](const auto& winding) {
        const auto current = winding.currents();
        std::copy(current.begin(), current.end(), result.begin());
      },
      winding_);
  return result;
}

double PwmAxis::speed() const {
  return std::visit([](const auto& winding) { return winding.speed(); }, winding_);
}

double PwmAxis::revolutions() const {
  return std::visit(
      [](const auto& winding) {
        return electrical_radians(winding.angle()) / (base::kTwoPi * winding.pole_pairs());
      },
      winding_);
}

double PwmAxis::electromagnetic_torque() const {
  return std::visit([](const auto& winding) { return winding.torque(); }, winding_);
}

}  // namespace stator::plant
