#include "plant/hybrid_stepper.hpp"

#include <algorithm>
#include <cmath>

namespace stator::plant {

namespace {

/// rad/s; no shaft of this kind survives it. Speed is cut here so that a torque set by mistake
/// cannot make the number of steps, or the numbers, grow without bound.
constexpr double kHighestSpeed = 1e4;

/// `direction` turned by a small angle (rad): error below 2e-10 for 0.33. The series are grouped so
/// that their terms can be computed side by side, for a step waits for nothing longer than for
/// this.
base::SineCosine rotated(const base::SineCosine& direction, double angle) {
  const double z = angle * angle;
  const double z2 = z * z;
  const double sine = angle * ((1.0 - z * (1.0 / 6.0)) + z2 * (1.0 / 120.0 - z * (1.0 / 5040.0)));
  const double cosine =
      (1.0 - 0.5 * z) + z2 * ((1.0 / 24.0 - z * (1.0 / 720.0)) + z2 * (1.0 / 40320.0));
  return {direction.sine * cosine + direction.cosine * sine,
          direction.cosine * cosine - direction.sine * sine};
}

/// From `to` to `angle` in mechanical radians.
double mechanical_distance(const ElectricalAngle& to, const ElectricalAngle& angle,
                           std::int64_t pole_pairs) {
  return (static_cast<double>(angle.periods - to.periods) * base::kTwoPi +
          (angle.angle - to.angle)) /
         static_cast<double>(pole_pairs);
}

}  // namespace

struct HybridStepper::Derivative {
  std::array<double, 2> current;
  double speed;
};

/// What one step holds fast: friction's direction, and where the shaft was when the step began.
struct HybridStepper::StepConstants {
  std::array<double, 2> voltage_gain{};  ///< 1/L, or 0 for an open phase
  std::array<double, 2> voltage{};
  double steady_torque = 0.0;  ///< load and outside, N m
  double friction_sign = 0.0;  ///< -1, 0, 1
  double coulomb_friction = 0.0;
  base::SineCosine shaft{};     ///< of the mechanical angle, for the unbalance
  double beyond_minimum = 0.0;  ///< mechanical rad the shaft is above the lower end stop
  double beyond_maximum = 0.0;  ///< and above the upper one
};

HybridStepper::HybridStepper(const StepperMotorParameters& motor, const MechanicalLoad& load)
    : motor_(motor),
      load_(load),
      pole_pairs_(motor.pole_pairs),
      inverse_pole_pairs_(1.0 / motor.pole_pairs),
      torque_constant_(motor.pole_pairs * motor.flux_linkage),
      inverse_inductance_(1.0 / motor.inductance),
      inverse_inertia_(1.0 / (motor.rotor_inertia + load.inertia)),
      viscous_friction_(motor.viscous_friction + load.viscous_friction),
      coulomb_friction_(motor.coulomb_friction + load.coulomb_friction),
      stribeck_rise_(std::max(0.0, motor.static_friction - motor.coulomb_friction)),
      inverse_stribeck_speed_(1.0 / motor.stribeck_speed),
      has_end_stops_(std::isfinite(load.end_stop_minimum) || std::isfinite(load.end_stop_maximum)),
      depends_on_position_(has_end_stops_ || load.unbalance_torque != 0.0) {
  // Torque per shaft radian: holding torque at rated current, detent torque, the pendulum.
  const double stiffness = motor.pole_pairs * (motor.holding_torque() + 4.0 * motor.detent_torque) +
                           std::fabs(load.unbalance_torque) +
                           (has_end_stops_ ? load.end_stop_stiffness : 0.0);
  const double damping = viscous_friction_ + (has_end_stops_ ? load.end_stop_damping : 0.0);
  standstill_rate_ =
      std::max({motor.resistance / motor.inductance, std::sqrt(stiffness * inverse_inertia_),
                damping * inverse_inertia_});
  // A stop out of the range of ElectricalAngle is none.
  constexpr double kFar = 1e12;
  end_stop_minimum_ = angle_at(std::max(load.end_stop_minimum, -kFar));
  end_stop_maximum_ = angle_at(std::min(load.end_stop_maximum, kFar));
}

ElectricalAngle HybridStepper::angle_at(double revolutions) const {
  const double periods = revolutions * static_cast<double>(pole_pairs_);
  const double whole = std::floor(periods);
  return turned({static_cast<std::int64_t>(whole), 0.0}, (periods - whole) * base::kTwoPi);
}

double HybridStepper::revolutions(const HybridStepperState& state) const {
  return (static_cast<double>(state.angle.periods) + state.angle.angle * (1.0 / base::kTwoPi)) *
         inverse_pole_pairs_;
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
  return frozen.steady_torque +
         (depends_on_position_ ? positional_torque(frozen, 0.0, state.speed) : 0.0);
}

double HybridStepper::positional_torque(const StepConstants& frozen, double turned,
                                        double speed) const {
  // Within a step the shaft turns by less than 0.33 / p rad: the series is exact to 1e-12.
  const double z = turned * turned;
  double torque = -load_.unbalance_torque * (frozen.shaft.sine * (1.0 - 0.5 * z) +
                                             frozen.shaft.cosine * turned * (1.0 - z / 6.0));
  if (has_end_stops_) {
    const double above = frozen.beyond_maximum + turned;
    if (above > 0.0) {
      torque -= std::max(0.0, load_.end_stop_stiffness * above + load_.end_stop_damping * speed);
    }
    const double below = -(frozen.beyond_minimum + turned);
    if (below > 0.0) {
      torque += std::max(0.0, load_.end_stop_stiffness * below - load_.end_stop_damping * speed);
    }
  }
  return torque;
}

HybridStepper::StepConstants HybridStepper::freeze(const HybridStepperState& state,
                                                   const HybridStepperInput& input) const {
  StepConstants frozen;
  for (std::size_t k = 0; k < 2; ++k) {
    frozen.voltage_gain[k] = input.open[k] ? 0.0 : inverse_inductance_;
    frozen.voltage[k] = input.voltage[k];
  }
  frozen.steady_torque = load_.constant_torque + input.torque;
  frozen.coulomb_friction = coulomb_friction_ + (input.brake_engaged ? load_.brake_torque : 0.0);
  if (depends_on_position_) {
    const std::int64_t period = state.angle.periods % pole_pairs_;
    frozen.shaft =
        base::sine_cosine(mechanical_distance({}, {period, state.angle.angle}, pole_pairs_));
    frozen.beyond_minimum = mechanical_distance(end_stop_minimum_, state.angle, pole_pairs_);
    frozen.beyond_maximum = mechanical_distance(end_stop_maximum_, state.angle, pole_pairs_);
  }
  return frozen;
}

inline double HybridStepper::dry_friction(const StepConstants& frozen, double speed) const {
  const double ratio = speed * inverse_stribeck_speed_;
  return frozen.coulomb_friction + stribeck_rise_ / (1.0 + ratio * ratio);
}

inline HybridStepper::Derivative HybridStepper::derivative(const StepConstants& frozen,
                                                           const std::array<double, 2>& current,
                                                           double speed,
                                                           const base::SineCosine& direction,
                                                           double turned, double friction) const {
  const double induced = torque_constant_ * speed;
  const double torque =
      torque_constant_ * (current[1] * direction.cosine - current[0] * direction.sine) -
      detent_torque(direction) - viscous_friction_ * speed - frozen.friction_sign * friction +
      frozen.steady_torque +
      (depends_on_position_ ? positional_torque(frozen, turned, speed) : 0.0);
  return {{frozen.voltage_gain[0] *
               (frozen.voltage[0] - motor_.resistance * current[0] + induced * direction.sine),
           frozen.voltage_gain[1] *
               (frozen.voltage[1] - motor_.resistance * current[1] - induced * direction.cosine)},
          torque * inverse_inertia_};
}

void HybridStepper::step(HybridStepperState& state, const HybridStepperInput& input,
                         double h) const {
  step(state, base::sine_cosine(state.angle.angle), input, h);
}

void HybridStepper::step(HybridStepperState& state, const base::SineCosine& direction,
                         const HybridStepperInput& input, double h) const {
  StepConstants frozen = freeze(state, input);
  if (state.speed != 0.0) {
    frozen.friction_sign = state.speed > 0.0 ? 1.0 : -1.0;
  } else {
    const double net = derivative(frozen, state.current, 0.0, direction, 0.0, 0.0).speed;
    const double holding = (frozen.coulomb_friction + stribeck_rise_) * inverse_inertia_;
    if (std::fabs(net) <= holding) {
      step_at_rest(state, input, h);
      return;
    }
    frozen.friction_sign = net > 0.0 ? 1.0 : -1.0;
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
  const Derivative k1 = derivative(frozen, i, w, direction, 0.0, dry_friction(frozen, w));
  const double friction_halfway = dry_friction(frozen, w + half * k1.speed);
  const double friction_at_end = dry_friction(frozen, w + h * k1.speed);
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
  settle_friction(state, frozen, w, h);
}

void HybridStepper::settle_friction(HybridStepperState& state, const StepConstants& frozen,
                                    double speed_before, double step_length) const {
  const double sign = frozen.friction_sign;
  if (state.speed * sign >= 0.0) {
    return;
  }
  // Speed crossed zero within the step: since then friction has pushed the wrong way.
  const double after_crossing = step_length * (state.speed / (state.speed - speed_before));
  const double friction = (frozen.coulomb_friction + stribeck_rise_) * inverse_inertia_;
  const double corrected = state.speed + sign * 2.0 * friction * after_crossing;
  const double settled = corrected * sign >= 0.0 ? 0.0 : corrected;
  const double excess = 0.5 * (settled - state.speed) * after_crossing;
  state.angle = turned(state.angle, excess * static_cast<double>(pole_pairs_));
  state.speed = settled;
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
