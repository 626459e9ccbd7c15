#include "stator/plant/mechanics/shaft_mechanics.hpp"

namespace stator::plant {

ShaftMechanics::ShaftMechanics(const RotorMechanics& rotor, const MechanicalLoad& load)
    : load_(load),
      pole_pairs_(rotor.pole_pairs),
      inverse_pole_pairs_(1.0 / static_cast<double>(rotor.pole_pairs)),
      inertia_(rotor.inertia + load.inertia),
      inverse_inertia_(1.0 / inertia_),
      viscous_friction_(rotor.viscous_friction + load.viscous_friction),
      coulomb_friction_(rotor.coulomb_friction + load.coulomb_friction),
      stribeck_rise_(std::max(0.0, rotor.static_friction - rotor.coulomb_friction)),
      inverse_stribeck_speed_(1.0 / rotor.stribeck_speed),
      has_end_stops_(std::isfinite(load.end_stop_minimum) || std::isfinite(load.end_stop_maximum)),
      depends_on_position_(has_end_stops_ || load.unbalance_torque != 0.0) {
  // A stop out of the range of ElectricalAngle is none.
  constexpr double kFar = 1e12;
  end_stop_minimum_ = angle_at(std::max(load.end_stop_minimum, -kFar));
  end_stop_maximum_ = angle_at(std::min(load.end_stop_maximum, kFar));
}

double ShaftMechanics::fastest_rate(double stiffness, bool at_end_stop) const {
  const double spring = stiffness + std::fabs(load_.unbalance_torque) +
                        (at_end_stop ? load_.end_stop_stiffness : 0.0);
  const double damping = viscous_friction_ + (at_end_stop ? load_.end_stop_damping : 0.0);
  return std::max(std::sqrt(spring * inverse_inertia_), damping * inverse_inertia_);
}

ElectricalAngle ShaftMechanics::angle_at(double revolutions) const {
  const double periods = revolutions * static_cast<double>(pole_pairs_);
  const double whole = std::floor(periods);
  return turned({static_cast<std::int64_t>(whole), 0.0}, (periods - whole) * base::kTwoPi);
}

void ShaftMechanics::locate(Frozen& frozen, const ElectricalAngle& angle) const {
  if (load_.unbalance_torque != 0.0) {
    const std::int64_t period = angle.periods % pole_pairs_;
    frozen.shaft = base::sine_cosine(mechanical_distance({}, {period, angle.angle}));
    frozen.positional = true;
  }
  if (has_end_stops_) {
    frozen.beyond_minimum = mechanical_distance(end_stop_minimum_, angle);
    frozen.beyond_maximum = mechanical_distance(end_stop_maximum_, angle);
    frozen.positional = frozen.positional || frozen.beyond_minimum < inverse_pole_pairs_ ||
                        frozen.beyond_maximum > -inverse_pole_pairs_;
  }
}

bool ShaftMechanics::settle(double& speed, ElectricalAngle& angle, const Frozen& frozen,
                            double speed_before, double step) const {
  const double sign = frozen.friction_sign;
  if (speed * sign >= 0.0) [[likely]] {
    return false;
  }
  const double after_crossing = step * (speed / (speed - speed_before));
  const double friction = holding_friction(frozen) * inverse_inertia_;
  const double corrected = speed + sign * 2.0 * friction * after_crossing;
  const double settled = corrected * sign >= 0.0 ? 0.0 : corrected;
  const double excess = 0.5 * (settled - speed) * after_crossing;
  angle = turned(angle, excess * static_cast<double>(pole_pairs_));
  speed = settled;
  return true;
}

}  // namespace stator::plant
