#include "stator/experiment/equations.hpp"

#include <algorithm>
#include <cmath>

namespace stator::experiment {

Equations::Equations(const plant::StepperAxisParameters& axis)
    : motor_(axis.motor),
      supply_(axis.supply_voltage),
      torque_constant_(axis.motor.pole_pairs * axis.motor.flux_linkage),
      inertia_(axis.motor.rotor_inertia + axis.load.inertia),
      viscous_(axis.motor.viscous_friction + axis.load.viscous_friction),
      coulomb_(axis.motor.coulomb_friction + axis.load.coulomb_friction),
      load_torque_(axis.load.constant_torque) {}

double Equations::rated_current() const {
  return std::sqrt(2.0) * motor_.rated_current;
}

double Equations::running_torque(double speed) const {
  return coulomb_ + viscous_ * speed - load_torque_;
}

double Equations::impedance(double speed) const {
  return std::hypot(motor_.resistance, motor_.pole_pairs * speed * motor_.inductance);
}

double Equations::corner_speed(double current) const {
  const double reactance = motor_.pole_pairs * motor_.inductance * current;
  const double drop = motor_.resistance * current;
  const double a = torque_constant_ * torque_constant_ + reactance * reactance;
  const double b = torque_constant_ * drop;
  const double c = drop * drop - supply_ * supply_;
  return c >= 0.0 ? 0.0 : (std::sqrt(b * b - a * c) - b) / a;
}

double Equations::regulator_demand(double speed, double current) const {
  return impedance(speed) * current / supply_;
}

double Equations::regulated_pull_out(double current) const {
  return torque_constant_ * current;
}

double Equations::voltage_pull_out(double speed, double amplitude) const {
  const double z = impedance(speed);
  return torque_constant_ / z * (amplitude - torque_constant_ * speed * motor_.resistance / z);
}

double Equations::saturated_pull_out(double speed) const {
  return voltage_pull_out(speed, 4.0 / base::kPi * supply_);
}

double Equations::stiffness(double current) const {
  return torque_constant_ * current + 4.0 * motor_.detent_torque;
}

double Equations::natural_frequency(double current) const {
  return std::sqrt(motor_.pole_pairs * stiffness(current) / inertia_);
}

double Equations::logarithmic_decrement(double current) const {
  const double rate = decay_rate();
  const double natural = natural_frequency(current);
  return rate * base::kTwoPi / std::sqrt(natural * natural - rate * rate);
}

double Equations::dry_deflection(double current) const {
  return coulomb_ / stiffness(current);
}

double Equations::accelerated_speed(double current, double time) const {
  const double torque = torque_constant_ * current - coulomb_ + load_torque_;
  return viscous_ > 0.0 ? -torque / viscous_ * std::expm1(-viscous_ * time / inertia_)
                        : torque * time / inertia_;
}

double Equations::acceleration_time(double current, double speed) const {
  const double torque = torque_constant_ * current - coulomb_ + load_torque_;
  return viscous_ > 0.0 ? -inertia_ / viscous_ * std::log1p(-viscous_ * speed / torque)
                        : inertia_ * speed / torque;
}

double Equations::coasting_speed(double initial_speed, double time) const {
  const double dry = coulomb_ - load_torque_;
  const double speed =
      viscous_ > 0.0 ? (initial_speed + dry / viscous_) * std::exp(-viscous_ * time / inertia_) -
                           dry / viscous_
                     : initial_speed - dry / inertia_ * time;
  return std::max(0.0, speed);
}

double Equations::coasting_time(double initial_speed) const {
  const double dry = coulomb_ - load_torque_;
  return viscous_ > 0.0 ? inertia_ / viscous_ * std::log1p(viscous_ * initial_speed / dry)
                        : inertia_ * initial_speed / dry;
}

double Equations::load_angle_sine(double torque, double current) const {
  return std::clamp(torque / (torque_constant_ * current), -1.0, 1.0);
}

double Equations::stall_guard(double speed, double torque, double current,
                              double counts_per_volt) const {
  const double unused = torque_constant_ * speed * (1.0 - torque / regulated_pull_out(current));
  return std::clamp(counts_per_volt * unused, 0.0, 1023.0);
}

}  // namespace stator::experiment
