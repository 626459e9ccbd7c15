#include "stator/environment/servo_drives.hpp"

#include "stator/base/trigonometry.hpp"

namespace stator::environment {

namespace {

/// Of a current loop by the period of its steps: the fastest without overshoot.
constexpr double kBandwidthByPeriod = 0.2;

control::CurrentLoopSettings loop_of(const EnvironmentSettings& settings) {
  const double period = settings.step.seconds();
  if (settings.action != ActionKind::current) {
    // It modulates the voltages that it is told.
    return {.proportional = 0.0, .integral = 0.0, .period = period};
  }
  const plant::ServoAxisParameters& axis = settings.servo;
  return control::current_loop_for(
      axis.motor.resistance + axis.inverter.on_resistance, axis.motor.direct_inductance,
      settings.bandwidth.value_or(kBandwidthByPeriod / period), period);
}

}  // namespace

template <typename Number>
ServoDrives<Number>::ServoDrives(const EnvironmentSettings& settings, const Scales& scales,
                                 std::size_t axes)
    : action_(settings.action),
      steps_(settings.steps_per_action),
      scales_(scales),
      inverse_pole_pairs_(1.0 / settings.servo.motor.pole_pairs),
      plants_(settings.servo, axes, settings.step),
      loops_(loop_of(settings), axes) {}

template <typename Number>
void ServoDrives<Number>::restart(std::size_t axis, const Conditions& conditions) {
  const plant::ServoAxisParameters& nominal = plants_.parameters();
  plant::ThreePhaseMotorParameters motor = nominal.motor;
  // What dry friction rises by at rest belongs to the motor and goes with its friction.
  const double rise = motor.static_friction - motor.coulomb_friction;
  const double share = motor.coulomb_friction + nominal.load.coulomb_friction;
  motor.viscous_friction = conditions.viscous_friction;
  motor.coulomb_friction = conditions.coulomb_friction;
  motor.static_friction = conditions.coulomb_friction +
                          (share > 0.0 ? rise * (conditions.coulomb_friction / share) : rise);
  motor.resistance = conditions.resistance;
  motor.quadrature_inductance *= conditions.inductance / motor.direct_inductance;
  motor.direct_inductance = conditions.inductance;
  motor.flux_linkage = conditions.flux_linkage;
  plant::MechanicalLoad load = nominal.load;
  load.inertia = conditions.inertia;
  load.viscous_friction = 0.0;
  load.coulomb_friction = 0.0;
  plants_.set_plant(axis, motor, load);
  plants_.restart(axis, conditions.initial_position, conditions.initial_speed,
                  conditions.supply_voltage);
  loops_.restart(axis);
}

template <typename Number>
void ServoDrives<Number>::act(std::span<const float> actions) {
  const std::size_t axes = plants_.size();
  switch (action_) {
    case ActionKind::current:
      for (std::size_t n = 0; n < axes; ++n) {
        loops_.set_target(n, 0.0, scales_.current * static_cast<double>(actions[n]));
      }
      break;
    case ActionKind::voltage:
      for (std::size_t n = 0; n < axes; ++n) {
        loops_.set_voltage(n, scales_.voltage * static_cast<double>(actions[2 * n]),
                           scales_.voltage * static_cast<double>(actions[2 * n + 1]));
      }
      break;
    case ActionKind::duty:
      for (std::size_t n = 0; n < axes; ++n) {
        base::ServoLanes<Number>& signals = plants_.signals()[n / kLanes];
        for (std::size_t phase = 0; phase < 3; ++phase) {
          signals.duty[phase][n % kLanes] =
              static_cast<Number>(0.5 + 0.5 * static_cast<double>(actions[3 * n + phase]));
        }
      }
      break;
  }
}

template <typename Number>
void ServoDrives<Number>::pass() {
  for (int n = 0; n < steps_; ++n) {
    if (action_ != ActionKind::duty) {
      loops_.step(plants_.signals());
    }
    plants_.step();
  }
}

template <typename Number>
void ServoDrives<Number>::read(std::span<Reading> readings) const {
  for (std::size_t n = 0; n < readings.size(); ++n) {
    readings[n] = ServoDrives::read(n);
  }
}

template <typename Number>
Reading ServoDrives<Number>::read(std::size_t axis) const {
  const base::ServoLanes<Number>& signals = plants_.signals()[axis / kLanes];
  const std::size_t lane = axis % kLanes;
  const base::SineCosine seen = base::sine_cosine(static_cast<double>(signals.angle[lane]));
  const plant::StatorVector current =
      plant::stator_vector(signals.phase_current[0][lane], signals.phase_current[1][lane],
                           signals.phase_current[2][lane]);
  const plant::SynchronousMotorState motor = plants_.motor(axis);
  return {.direct_current = seen.cosine * current.alpha + seen.sine * current.beta,
          .quadrature_current = seen.cosine * current.beta - seen.sine * current.alpha,
          .sine = seen.sine,
          .cosine = seen.cosine,
          .speed = motor.speed,
          .revolutions = (static_cast<double>(motor.angle.periods) +
                          motor.angle.angle * (1.0 / base::kTwoPi)) *
                         inverse_pole_pairs_,
          .supply_voltage = static_cast<double>(signals.supply_voltage[lane])};
}

template class ServoDrives<double>;
template class ServoDrives<float>;

}  // namespace stator::environment
