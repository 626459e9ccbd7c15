#include "stator/environment/settings.hpp"

namespace stator::environment {

namespace {

using namespace base::literals;

constexpr double kInverseSquareRootOfThree = 0.57735026918962576451;
constexpr double kSquareRootOfTwo = 1.41421356237309504880;
/// Beyond the largest current that is asked for; a drive that regulates it does not come there.
constexpr double kTrip = 1.5;

void set_times(EnvironmentSettings& settings) {
  const bool servo = settings.plant == PlantKind::servo;
  settings.step = servo ? 20_us : 50_us;
  switch (settings.task) {
    case Task::torque:
      settings.steps_per_action = 1;
      settings.episode = servo ? 20_ms : 50_ms;
      settings.shortest_hold = servo ? 2_ms : 5_ms;
      settings.longest_hold = servo ? 6_ms : 15_ms;
      break;
    case Task::velocity:
      settings.steps_per_action = servo ? 25 : 10;
      settings.episode = 250_ms;
      settings.shortest_hold = 50_ms;
      settings.longest_hold = 150_ms;
      break;
    case Task::position:
      settings.steps_per_action = servo ? 50 : 20;
      settings.episode = 500_ms;
      settings.shortest_hold = 100_ms;
      settings.longest_hold = 300_ms;
      break;
  }
}

double target_of(const EnvironmentSettings& settings, const Scales& scales) {
  switch (settings.task) {
    case Task::torque:
      return 0.8 * scales.torque_constant * scales.current;
    case Task::velocity:
      return 0.8 * scales.rated_speed;
    case Task::position:
      break;
  }
  return 1.0;
}

}  // namespace

EnvironmentSettings usual_settings(PlantKind plant, Task task) {
  EnvironmentSettings settings;
  settings.plant = plant;
  settings.task = task;
  settings.action = task == Task::torque ? ActionKind::voltage : ActionKind::current;
  settings.servo.load.inertia = settings.servo.motor.rotor_inertia;
  settings.stepper.load.inertia = settings.stepper.motor.rotor_inertia;
  set_times(settings);
  if (task == Task::torque) {
    settings.randomisation.initial_speed = {-0.4, 0.4};
  }
  return settings;
}

Scales scales_of(const EnvironmentSettings& settings) {
  Scales scales;
  double current = 0.0;
  double speed = 0.0;
  if (settings.plant == PlantKind::servo) {
    const plant::ThreePhaseMotorParameters& motor = settings.servo.motor;
    current = 2.0 * motor.rated_current;
    speed = 1.5 * motor.rated_speed;
    scales.supply_voltage = settings.servo.supply_voltage;
    scales.voltage = kInverseSquareRootOfThree * scales.supply_voltage;
    scales.torque_constant = motor.torque_constant();
    scales.rated_torque = scales.torque_constant * motor.rated_current;
    scales.rated_speed = motor.rated_speed;
  } else {
    const plant::StepperMotorParameters& motor = settings.stepper.motor;
    current = kSquareRootOfTwo * motor.rated_current;
    scales.supply_voltage = settings.stepper.supply_voltage;
    scales.voltage = scales.supply_voltage;
    scales.torque_constant = motor.pole_pairs * motor.flux_linkage;
    scales.rated_torque = motor.holding_torque();
    // Half of the speed at which the EMF is as large as the supply's voltage.
    scales.rated_speed = 0.5 * scales.supply_voltage / scales.torque_constant;
    speed = 3.0 * scales.rated_speed;
  }
  scales.current = settings.current_limit.value_or(current);
  scales.trip_current = settings.trip_current.value_or(kTrip * scales.current);
  scales.speed_limit = settings.speed_limit.value_or(speed);
  scales.travel_limit = settings.travel_limit;
  scales.largest_target = settings.largest_target.value_or(target_of(settings, scales));
  return scales;
}

Conditions nominal_conditions(const EnvironmentSettings& settings) {
  const auto of = [](const auto& motor, const auto& axis, double inductance) {
    return Conditions{.inertia = axis.load.inertia,
                      .viscous_friction = motor.viscous_friction + axis.load.viscous_friction,
                      .coulomb_friction = motor.coulomb_friction + axis.load.coulomb_friction,
                      .resistance = motor.resistance,
                      .inductance = inductance,
                      .flux_linkage = motor.flux_linkage,
                      .supply_voltage = axis.supply_voltage};
  };
  if (settings.plant == PlantKind::servo) {
    const plant::ThreePhaseMotorParameters& motor = settings.servo.motor;
    return of(motor, settings.servo, motor.direct_inductance);
  }
  return of(settings.stepper.motor, settings.stepper, settings.stepper.motor.inductance);
}

}  // namespace stator::environment
