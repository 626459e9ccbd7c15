#include "stator/plant/motors/hybrid_stepper.hpp"

#include <algorithm>
#include <cmath>

namespace stator::plant {

namespace {

/// rad/s; no shaft of this kind survives it. Speed is cut here so that a torque set by mistake
/// cannot make the number of steps, or the numbers, grow without bound.
constexpr double kHighestSpeed = 1e4;

RotorMechanics rotor_of(const StepperMotorParameters& motor) {
  return {.inertia = motor.rotor_inertia,
          .viscous_friction = motor.viscous_friction,
          .coulomb_friction = motor.coulomb_friction,
          .static_friction = motor.static_friction,
          .stribeck_speed = motor.stribeck_speed,
          .pole_pairs = motor.pole_pairs};
}

}  // namespace

struct HybridStepper::Derivative {
  std::array<double, 2> current;
  double speed;
};

/// What one step holds fast.
struct HybridStepper::StepConstants {
  std::array<double, 2> voltage_gain{};  ///< 1/L, or 0 for an open phase
  std::array<double, 2> voltage{};
  ShaftMechanics::Frozen shaft;
};

HybridStepper::HybridStepper(const StepperMotorParameters& motor, const MechanicalLoad& load)
    : motor_(motor),
      shaft_(rotor_of(motor), load),
      pole_pairs_(motor.pole_pairs),
      torque_constant_(motor.pole_pairs * motor.flux_linkage),
      inverse_inductance_(1.0 / motor.inductance),
      electrical_rate_(motor.resistance / motor.inductance) {
  set_load(load);
}

void HybridStepper::set_load(const MechanicalLoad& load) {
  shaft_ = ShaftMechanics(rotor_of(motor_), load);
  // Torque per shaft radian: holding torque at rated current and detent torque.
  const double stiffness =
      motor_.pole_pairs * (motor_.holding_torque() + 4.0 * motor_.detent_torque);
  standstill_rate_ =
      std::max(electrical_rate_, shaft_.fastest_rate(stiffness, shaft_.has_end_stops()));
}

double HybridStepper::fastest_rate(const HybridStepperState& state) const {
  return std::max(standstill_rate_, std::fabs(state.speed) * static_cast<double>(pole_pairs_));
}

std::array<double, 2> HybridStepper::induced_voltage(const base::SineCosine& direction,
                                                     double speed) const {
  const double amplitude = torque_constant_ * speed;
  return {-amplitude * direction.sine, amplitude * direction.cosine};
}

double HybridStepper::detent_torque(const base::SineCosine& direction) const {
  // sin 4x = 4 sin x cos x (cos^2 x - sin^2 x)
  const double s = direction.sine;
  const double c = direction.cosine;
  return motor_.detent_torque * 4.0 * (s * c) * (c * c - s * s);
}

double HybridStepper::detent_torque(const HybridStepperState& state) const {
  return detent_torque(base::sine_cosine(state.angle.angle));
}

double HybridStepper::electromagnetic_torque(const HybridStepperState& state) const {
  const base::SineCosine direction = base::sine_cosine(state.angle.angle);
  return torque_constant_ *
         (state.current[1] * direction.cosine - state.current[0] * direction.sine);
}

double HybridStepper::load_angle(const HybridStepperState& state) const {
  const base::SineCosine direction = base::sine_cosine(state.angle.angle);
  return base::arc_tangent(state.current[1] * direction.cosine - state.current[0] * direction.sine,
                           state.current[0] * direction.cosine + state.current[1] * direction.sine);
}

double HybridStepper::load_torque(const HybridStepperState& state, double outside_torque) const {
  HybridStepperInput input;
  input.torque = outside_torque;
  const StepConstants frozen = freeze(state, input);
  return frozen.shaft.steady_torque +
         (shaft_.depends_on_position() ? shaft_.positional_torque(frozen.shaft, 0.0, state.speed)
                                       : 0.0);
}

HybridStepper::StepConstants HybridStepper::freeze(const HybridStepperState& state,
                                                   const HybridStepperInput& input) const {
  StepConstants frozen;
  for (std::size_t k = 0; k < 2; ++k) {
    frozen.voltage_gain[k] = input.open[k] ? 0.0 : inverse_inductance_;
    frozen.voltage[k] = input.voltage[k];
  }
  frozen.shaft = shaft_.freeze(state.angle, input.torque, input.brake_engaged);
  return frozen;
}

inline HybridStepper::Derivative HybridStepper::derivative(const StepConstants& frozen,
                                                           const std::array<double, 2>& current,
                                                           double speed,
                                                           const base::SineCosine& direction,
                                                           double turned, double friction) const {
  const double induced = torque_constant_ * speed;
  const double torque =
      torque_constant_ * (current[1] * direction.cosine - current[0] * direction.sine) -
      detent_torque(direction) - shaft_.viscous_friction() * speed -
      frozen.shaft.friction_sign * friction + frozen.shaft.steady_torque +
      (shaft_.depends_on_position() ? shaft_.positional_torque(frozen.shaft, turned, speed) : 0.0);
  return {{frozen.voltage_gain[0] *
               (frozen.voltage[0] - motor_.resistance * current[0] + induced * direction.sine),
           frozen.voltage_gain[1] *
               (frozen.voltage[1] - motor_.resistance * current[1] - induced * direction.cosine)},
          torque * shaft_.inverse_inertia()};
}

void HybridStepper::step(HybridStepperState& state, const HybridStepperInput& input,
                         double h) const {
  step(state, base::sine_cosine(state.angle.angle), input, h);
}

void HybridStepper::step(HybridStepperState& state, const base::SineCosine& direction,
                         const HybridStepperInput& input, double h) const {
  StepConstants frozen = freeze(state, input);
  if (state.speed != 0.0) {
    frozen.shaft.friction_sign = state.speed > 0.0 ? 1.0 : -1.0;
  } else {
    const double net = derivative(frozen, state.current, 0.0, direction, 0.0, 0.0).speed;
    const double holding = shaft_.holding_friction(frozen.shaft) * shaft_.inverse_inertia();
    if (std::fabs(net) <= holding) {
      step_at_rest(state, input, h);
      return;
    }
    frozen.shaft.friction_sign = net > 0.0 ? 1.0 : -1.0;
  }

  const auto pole_pairs = static_cast<double>(pole_pairs_);
  const std::array<double, 2>& i = state.current;
  const double w = state.speed;
  const double half = 0.5 * h;
  const auto ahead = [&i](const Derivative& slope, double time) {
    return std::array{i[0] + time * slope.current[0], i[1] + time * slope.current[1]};
  };
  const auto stage = [&](const Derivative& slope, double time, double turned, double friction) {
    return derivative(frozen, ahead(slope, time), w + time * slope.speed,
                      rotated(direction, turned * pole_pairs), turned, friction);
  };
  // Classical fourth-order Runge-Kutta; the angle's derivative is the speed of the stage before.
  // The Stribeck curve is taken at the speeds to which the first slope leads: its divisions then
  // run beside the stages and not between them.
  const Derivative k1 =
      derivative(frozen, i, w, direction, 0.0, shaft_.dry_friction(frozen.shaft, w));
  const double friction_halfway = shaft_.dry_friction(frozen.shaft, w + half * k1.speed);
  const double friction_at_end = shaft_.dry_friction(frozen.shaft, w + h * k1.speed);
  const Derivative k2 = stage(k1, half, half * w, friction_halfway);
  const Derivative k3 = stage(k2, half, half * (w + half * k1.speed), friction_halfway);
  const Derivative k4 = stage(k3, h, h * (w + half * k2.speed), friction_at_end);

  const double sixth = h / 6.0;
  for (std::size_t k = 0; k < 2; ++k) {
    state.current[k] +=
        sixth * (k1.current[k] + 2.0 * (k2.current[k] + k3.current[k]) + k4.current[k]);
  }
  state.speed += sixth * (k1.speed + 2.0 * (k2.speed + k3.speed) + k4.speed);
  const double turned_by = h * (w + sixth * (k1.speed + k2.speed + k3.speed));
  state.speed = std::clamp(state.speed, -kHighestSpeed, kHighestSpeed);
  state.angle = turned(state.angle, turned_by * pole_pairs);
  shaft_.settle(state.speed, state.angle, frozen.shaft, w, h);
}

void HybridStepper::step_at_rest(HybridStepperState& state, const HybridStepperInput& input,
                                 double step_length) const {
  const double z = motor_.resistance * inverse_inductance_ * step_length;
  // The fourth-order Runge-Kutta step of L di/dt = u - R i.
  const double gain = step_length * inverse_inductance_ *
                      (1.0 - z * (1.0 / 2.0 - z * (1.0 / 6.0 - z * (1.0 / 24.0))));
  for (std::size_t k = 0; k < 2; ++k) {
    if (!input.open[k]) {
      state.current[k] += gain * (input.voltage[k] - motor_.resistance * state.current[k]);
    }
  }
}

}  // namespace stator::plant
