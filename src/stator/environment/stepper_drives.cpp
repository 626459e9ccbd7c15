#include "stator/environment/stepper_drives.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "stator/base/trigonometry.hpp"

namespace stator::environment {

StepperDrives::StepperDrives(const EnvironmentSettings& settings, const Scales& scales,
                             std::size_t axes)
    : action_(settings.action),
      steps_(settings.steps_per_action),
      step_(settings.step),
      scales_(scales),
      parameters_(settings.stepper),
      counts_per_radian_(static_cast<double>(std::max(
                             settings.stepper.encoder.counts_per_revolution, std::int64_t{0})) /
                         (settings.stepper.motor.pole_pairs * base::kTwoPi)),
      action_size_(action_size(settings.plant, settings.action)),
      axes_(axes, plant::StepperAxis(settings.stepper)),
      actions_(axes * action_size_) {}

void StepperDrives::restart(std::size_t axis, const Conditions& conditions) {
  plant::StepperAxisParameters parameters = parameters_;
  plant::StepperMotorParameters& motor = parameters.motor;
  // What dry friction rises by at rest belongs to the motor and goes with its friction.
  const double rise = motor.static_friction - motor.coulomb_friction;
  const double share = motor.coulomb_friction + parameters.load.coulomb_friction;
  motor.viscous_friction = conditions.viscous_friction;
  motor.coulomb_friction = conditions.coulomb_friction;
  motor.static_friction = conditions.coulomb_friction +
                          (share > 0.0 ? rise * (conditions.coulomb_friction / share) : rise);
  motor.resistance = conditions.resistance;
  motor.inductance = conditions.inductance;
  motor.flux_linkage = conditions.flux_linkage;
  parameters.load.inertia = conditions.inertia;
  parameters.load.viscous_friction = 0.0;
  parameters.load.coulomb_friction = 0.0;
  parameters.supply_voltage = conditions.supply_voltage;
  parameters.initial_revolutions = conditions.initial_position;
  axes_[axis] = plant::StepperAxis(parameters);
  if (conditions.initial_speed != 0.0) {
    plant::StepperAxisState state = axes_[axis].state();
    state.motor.speed = conditions.initial_speed;
    axes_[axis].restore(state);
  }
}

void StepperDrives::act(std::span<const float> actions) {
  std::copy(actions.begin(), actions.end(), actions_.begin());
}

double StepperDrives::seen_angle(const plant::StepperAxis& axis) const {
  const double angle = axis.state().motor.angle.angle;
  if (counts_per_radian_ == 0.0) {
    return angle;
  }
  return (std::floor(angle * counts_per_radian_) + 0.5) / counts_per_radian_;
}

base::AxisActuation StepperDrives::actuation(const plant::StepperAxis& axis, const float* action,
                                             double ahead) const {
  base::AxisActuation result{.bridge_enabled = true};
  if (action_ == ActionKind::current) {
    // The chopper brings the coils to their targets at the end of the step, when the rotor is on.
    const double turn = axis.state().motor.speed * ahead;
    const base::SineCosine z = base::sine_cosine(seen_angle(axis) + turn);
    const double current = scales_.current * static_cast<double>(action[0]);
    result.coil_current_target = {-current * z.sine, current * z.cosine};
    return result;
  }
  result.voltage_mode = true;
  if (action_ == ActionKind::duty) {
    result.coil_duty = {action[0], action[1]};
    return result;
  }
  const base::SineCosine z = base::sine_cosine(seen_angle(axis));
  const double supply = axis.sensing().supply_voltage;
  const double share = supply > 0.0 ? scales_.voltage / supply : 0.0;
  const double direct = share * static_cast<double>(action[0]);
  const double quadrature = share * static_cast<double>(action[1]);
  result.coil_duty = {std::clamp(direct * z.cosine - quadrature * z.sine, -1.0, 1.0),
                      std::clamp(direct * z.sine + quadrature * z.cosine, -1.0, 1.0)};
  return result;
}

void StepperDrives::pass() {
  const double ahead = step_.seconds() * parameters_.motor.pole_pairs;
  for (std::size_t n = 0; n < axes_.size(); ++n) {
    for (int step = 0; step < steps_; ++step) {
      axes_[n].step(actuation(axes_[n], &actions_[n * action_size_], ahead), step_);
    }
  }
}

void StepperDrives::read(std::span<Reading> readings) const {
  for (std::size_t n = 0; n < readings.size(); ++n) {
    readings[n] = StepperDrives::read(n);
  }
}

Reading StepperDrives::read(std::size_t axis) const {
  const plant::StepperAxis& each = axes_[axis];
  const plant::HybridStepperState& motor = each.state().motor;
  const std::array<double, 2>& current = each.sensing().coil_current;
  const base::SineCosine seen = base::sine_cosine(seen_angle(each));
  return {.direct_current = seen.cosine * current[0] + seen.sine * current[1],
          .quadrature_current = seen.cosine * current[1] - seen.sine * current[0],
          .sine = seen.sine,
          .cosine = seen.cosine,
          .speed = motor.speed,
          .revolutions = (static_cast<double>(motor.angle.periods) +
                          motor.angle.angle * (1.0 / base::kTwoPi)) /
                         parameters_.motor.pole_pairs,
          .supply_voltage = each.sensing().supply_voltage};
}

}  // namespace stator::environment
