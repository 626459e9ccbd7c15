#include "stator/plant/motors/dc_motor.hpp"

#include <algorithm>

namespace stator::plant {

namespace {

RotorMechanics rotor_of(const DcMotorParameters& motor) {
  return {.inertia = motor.rotor_inertia,
          .viscous_friction = motor.viscous_friction,
          .coulomb_friction = motor.coulomb_friction,
          .static_friction = motor.static_friction,
          .stribeck_speed = motor.stribeck_speed,
          .pole_pairs = 1};
}

}  // namespace

DcMotor::DcMotor(const DcMotorParameters& motor, const MechanicalLoad& load)
    : motor_(motor),
      shaft_(rotor_of(motor), load),
      inverse_inductance_(1.0 / motor.inductance),
      resistance_(motor.resistance),
      torque_constant_(motor.torque_constant) {
  set_load(load);
}

void DcMotor::set_load(const MechanicalLoad& load) {
  shaft_ = ShaftMechanics(rotor_of(motor_), load);
  const double coupling = motor_.torque_constant * motor_.torque_constant * inverse_inductance_;
  fastest_rate_ = std::max(motor_.resistance * inverse_inductance_,
                           shaft_.fastest_rate(coupling, shaft_.has_end_stops()));
  transition_.step = -1.0;
}

void DcMotor::set_temperatures(double winding, double magnets) {
  constexpr double kSheetTemperature = 25.0;
  resistance_ =
      motor_.resistance * (1.0 + motor_.resistance_coefficient * (winding - kSheetTemperature));
  torque_constant_ =
      motor_.torque_constant * (1.0 + motor_.flux_coefficient * (magnets - kSheetTemperature));
  transition_.step = -1.0;
}

DcMotorState DcMotor::at(double revolutions) const {
  DcMotorState state;
  state.angle = shaft_.angle_at(revolutions);
  return state;
}

DcMotor::Matrix DcMotor::times(const Matrix& a, const Matrix& b) {
  return {a.a * b.a + a.b * b.c, a.a * b.b + a.b * b.d, a.c * b.a + a.d * b.c,
          a.c * b.b + a.d * b.d};
}

void DcMotor::renew(double h, double series_resistance, bool open) {
  Transition& t = transition_;
  t = {};
  t.step = h;
  t.series_resistance = series_resistance;
  t.open = open;
  const double rate = (resistance_ + series_resistance) * inverse_inductance_;
  const double mobility = shaft_.inverse_inertia();
  const Matrix a = open
                       ? Matrix{.d = -shaft_.viscous_friction() * mobility}
                       : Matrix{-rate, -torque_constant_ * inverse_inductance_,
                                torque_constant_ * mobility, -shaft_.viscous_friction() * mobility};
  // Power series; the step is short against all time constants.
  constexpr int kTerms = 18;
  Matrix power{1.0, 0.0, 0.0, 1.0};
  double alone = 1.0;
  double factor = 1.0;  // h^n / n!
  for (int n = 0; n < kTerms; ++n) {
    const auto add = [&power](Matrix& to, double weight) {
      to.a += weight * power.a;
      to.b += weight * power.b;
      to.c += weight * power.c;
      to.d += weight * power.d;
    };
    const double next = factor * h / (n + 1);
    add(t.state, factor);
    add(t.input, next);
    add(t.twice, next * h / (n + 2));
    t.charge += next * alone;
    t.charge2 += next * h / (n + 2) * alone;
    power = times(power, a);
    alone *= -rate;
    factor = next;
  }
  t.decay = 1.0 - rate * t.charge;
}

double DcMotor::step_at_rest(DcMotorState& state, const DcMotorInput& input, double h) const {
  if (input.open) {
    return 0.0;
  }
  const double rise = input.voltage * inverse_inductance_;
  const double charge = transition_.charge * state.current + transition_.charge2 * rise;
  state.current = transition_.decay * state.current + transition_.charge * rise;
  return input.voltage * charge / h;
}

double DcMotor::step(DcMotorState& state, const DcMotorInput& input, double h) {
  if (transition_.step != h || transition_.series_resistance != input.series_resistance ||
      transition_.open != input.open) [[unlikely]] {
    renew(h, input.series_resistance, input.open);
  }
  if (input.open) {
    state.current = 0.0;
  }
  ShaftMechanics::Frozen frozen = shaft_.freeze(state.angle, input.torque, input.brake_engaged);
  double load = frozen.steady_torque;
  if (frozen.positional) {
    load += shaft_.positional_torque(frozen, 0.5 * h * state.speed, state.speed);
  }
  const double speed_before = state.speed;
  if (speed_before == 0.0) {
    const double torque = torque_constant_ * state.current + load;
    if (std::fabs(torque) <= shaft_.holding_friction(frozen)) {
      return step_at_rest(state, input, h);
    }
    frozen.friction_sign = torque > 0.0 ? 1.0 : -1.0;
  } else {
    frozen.friction_sign = speed_before > 0.0 ? 1.0 : -1.0;
  }
  const double friction = frozen.friction_sign * shaft_.dry_friction(frozen, speed_before);
  const double rise = input.open ? 0.0 : input.voltage * inverse_inductance_;
  const double gain = (load - friction) * shaft_.inverse_inertia();
  const Transition& t = transition_;
  const double current = state.current;
  const double charge =
      (t.input.a * current + t.input.b * speed_before) + (t.twice.a * rise + t.twice.b * gain);
  const double turn =
      (t.input.c * current + t.input.d * speed_before) + (t.twice.c * rise + t.twice.d * gain);
  state.current =
      (t.state.a * current + t.state.b * speed_before) + (t.input.a * rise + t.input.b * gain);
  state.speed =
      (t.state.c * current + t.state.d * speed_before) + (t.input.c * rise + t.input.d * gain);
  constexpr double kHighestSpeed = 1e4;  // rad/s; no shaft of this kind survives it
  state.speed = std::clamp(state.speed, -kHighestSpeed, kHighestSpeed);
  state.angle = turned(state.angle, turn);
  shaft_.settle(state.speed, state.angle, frozen, speed_before, h);
  return input.open ? 0.0 : input.voltage * charge / h;
}

}  // namespace stator::plant
