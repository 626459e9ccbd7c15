#include "stator/experiment/servo_equations.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace stator::experiment {

namespace {

constexpr double kPeriod = 50e-6;  // s
constexpr int kOuterDivider = 20;
constexpr double kRpm = base::kPi / 30.0;

using Matrix = std::array<std::array<double, 4>, 4>;

/// exp(a) by its series; |a| is below one.
Matrix exponential(const Matrix& a) {
  Matrix sum{};
  Matrix power{};
  for (std::size_t i = 0; i < 4; ++i) {
    sum[i][i] = power[i][i] = 1.0;
  }
  for (int n = 1; n <= 24; ++n) {
    Matrix next{};
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) {
        for (std::size_t k = 0; k < 4; ++k) {
          next[i][j] += power[i][k] * a[k][j] / n;
        }
      }
    }
    power = next;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) {
        sum[i][j] += power[i][j];
      }
    }
  }
  return sum;
}

}  // namespace

ServoEquations::ServoEquations(const plant::ServoAxisParameters& axis)
    : motor_(axis.motor),
      resistance_(axis.motor.resistance + axis.inverter.on_resistance),
      torque_constant_(axis.motor.torque_constant()),
      inertia_(axis.motor.rotor_inertia + axis.load.inertia),
      viscous_(axis.motor.viscous_friction + axis.load.viscous_friction),
      coulomb_(axis.motor.coulomb_friction + axis.load.coulomb_friction),
      load_torque_(axis.load.constant_torque) {}

ServoEquations::Point ServoEquations::at(double speed, double voltage) const {
  const double electrical = speed * motor_.pole_pairs;
  const double ld = motor_.direct_inductance;
  const double lq = motor_.quadrature_inductance;
  Point point{};
  point.quadrature_current = (voltage - electrical * motor_.flux_linkage) /
                             (resistance_ + electrical * electrical * ld * lq / resistance_);
  point.direct_current = electrical * lq * point.quadrature_current / resistance_;
  point.torque = torque_constant_ * point.quadrature_current + 1.5 * motor_.pole_pairs * (ld - lq) *
                                                                   point.direct_current *
                                                                   point.quadrature_current;
  point.shaft_torque = point.torque - coulomb_ - viscous_ * speed;
  const double electrical_power = 1.5 * voltage * point.quadrature_current;
  point.efficiency = point.shaft_torque * speed / electrical_power;
  return point;
}

double ServoEquations::free_speed(double voltage) const {
  double low = 0.0;
  double high = voltage / (motor_.pole_pairs * motor_.flux_linkage);
  for (int n = 0; n < 60; ++n) {
    const double middle = 0.5 * (low + high);
    (at(middle, voltage).shaft_torque + load_torque_ > 0.0 ? low : high) = middle;
  }
  return low;
}

double ServoEquations::line_to_line_emf(double speed) const {
  return std::sqrt(3.0) * motor_.pole_pairs * motor_.flux_linkage * speed;
}

double ServoEquations::slowing_time(double initial, double braking) const {
  const double steady = braking + coulomb_ - load_torque_;
  return viscous_ > 0.0 ? inertia_ / viscous_ * std::log1p(viscous_ * initial / steady)
                        : inertia_ * initial / steady;
}

double ServoEquations::slowing_speed(double initial, double braking, double time) const {
  const double steady = braking + coulomb_ - load_torque_;
  const double speed = viscous_ > 0.0
                           ? (initial + steady / viscous_) * std::exp(-viscous_ * time / inertia_) -
                                 steady / viscous_
                           : initial - steady * time / inertia_;
  return std::max(0.0, speed);
}

double ServoEquations::slowing_angle(double initial, double braking, double time) const {
  const double steady = braking + coulomb_ - load_torque_;
  const double moving = std::min(time, slowing_time(initial, braking));
  if (viscous_ <= 0.0) {
    return initial * moving - 0.5 * steady * moving * moving / inertia_;
  }
  const double limit = steady / viscous_;
  return -(initial + limit) * inertia_ / viscous_ * std::expm1(-viscous_ * moving / inertia_) -
         limit * moving;
}

LinearServo::LinearServo(const ServoEquations& equations,
                         const plant::ThreePhaseMotorParameters& motor,
                         const control::ServoControllerSettings& gains, bool locked)
    : current_p_(gains.torque_p / 256.0),
      current_i_(gains.torque_i / 65536.0),
      velocity_p_(control::outer_gain_unit(gains.commutation) * gains.velocity_p / 256e3 / kRpm),
      velocity_i_(control::outer_gain_unit(gains.commutation) * gains.velocity_i / 65536e3 / kRpm),
      position_p_(control::outer_gain_unit(gains.commutation) * gains.position_p / 15.0) {
  const double inductance = motor.quadrature_inductance;
  const double mobility = locked ? 0.0 : 1.0 / equations.inertia();
  // d/dt (current, speed, angle, voltage), the voltage being held.
  Matrix system{};
  system[0] = {-equations.resistance() / inductance,
               -motor.pole_pairs * motor.flux_linkage / inductance, 0.0, 1.0 / inductance};
  system[1] = {equations.torque_constant() * mobility, -equations.viscous_friction() * mobility,
               0.0, 0.0};
  system[2][1] = 1.0;
  for (auto& row : system) {
    for (double& element : row) {
      element *= kPeriod;
    }
  }
  const Matrix over_a_period = exponential(system);
  for (std::size_t i = 0; i < 3; ++i) {
    std::copy_n(over_a_period[i].begin(), 3, transition_[i].begin());
    by_voltage_[i] = over_a_period[i][3];
  }
}

void LinearServo::run_outer_loops(const Target& target) {
  const double speed = (angle() - last_angle_) / (kOuterDivider * kPeriod);
  last_angle_ = angle();
  if (target.loop == control::ServoLoop::torque) {
    current_target_ = target.value;
    return;
  }
  const double demand = target.loop == control::ServoLoop::position
                            ? position_p_ * (target.value - angle())
                            : target.value;
  const double error = demand - speed;
  speed_sum_ += error;
  current_target_ = velocity_p_ * error + velocity_i_ * speed_sum_;
}

void LinearServo::step(const Target& target) {
  if (period_++ % kOuterDivider == 0) {
    run_outer_loops(target);
  }
  const double error = current_target_ - current();
  current_sum_ += error;
  const double applied = voltage_;
  voltage_ = current_p_ * error + current_i_ * current_sum_;
  std::array<double, 3> next{};
  for (std::size_t i = 0; i < 3; ++i) {
    next[i] = by_voltage_[i] * applied;
    for (std::size_t j = 0; j < 3; ++j) {
      next[i] += transition_[i][j] * state_[j];
    }
  }
  state_ = next;
}

}  // namespace stator::experiment
