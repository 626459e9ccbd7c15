#include "stator/plant/motors/stepper_motor.hpp"

#include <array>

namespace stator::plant {

namespace {

// Trinamic QSH5718 and QSH6018 manuals, "Motor specifications".
constexpr std::array kSheets{
    // name                full steps   A    ohm   mH    N m   detent  g cm^2  kg
    StepperMotorSheet{"QSH5718-41-30-047", 200, 3.0, 0.6, 1.5, 0.47, 0.021, 77, 0.45},
    StepperMotorSheet{"QSH5718-55-30-098", 200, 3.0, 0.8, 2.1, 0.98, 0.030, 209, 0.65},
    StepperMotorSheet{"QSH5718-79-30-163", 200, 3.0, 0.8, 3.2, 1.63, 0.030, 335, 1.1},
    StepperMotorSheet{"QSH6018-86-28-310", 200, 2.8, 1.5, 6.8, 3.10, 0.100, 840, 1.4},
};

double rated_loss_when_hot(const StepperMotorParameters& motor) {
  return 2.0 * motor.resistance * motor.rated_current * motor.rated_current *
         (1.0 + motor.temperature_coefficient * kClassBRise);
}

}  // namespace

std::span<const StepperMotorSheet> stepper_motor_sheets() {
  return kSheets;
}

StepperMotorParameters parameters_of(const StepperMotorSheet& sheet) {
  constexpr double kSquareRootOfTwo = 1.41421356237309504880;
  StepperMotorParameters motor;
  motor.pole_pairs = sheet.full_steps_per_revolution / 4;
  motor.resistance = sheet.resistance;
  motor.inductance = sheet.inductance * 1e-3;
  motor.flux_linkage =
      sheet.holding_torque / (motor.pole_pairs * kSquareRootOfTwo * sheet.rated_current);
  motor.detent_torque = sheet.detent_torque;
  motor.rotor_inertia = sheet.rotor_inertia * 1e-7;
  motor.rated_current = sheet.rated_current;
  motor.thermal = class_b_motor(rated_loss_when_hot(motor), sheet.mass);
  return motor;
}

std::optional<StepperMotorParameters> find_stepper_motor(std::string_view name) {
  for (const StepperMotorSheet& sheet : kSheets) {
    if (sheet.name == name) {
      return parameters_of(sheet);
    }
  }
  return std::nullopt;
}

}  // namespace stator::plant
