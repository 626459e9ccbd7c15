#include "stator/plant/keys/stepper_axis_keys.hpp"

#include <array>
#include <string_view>
#include <vector>

#include "stator/plant/keys/surroundings_keys.hpp"
#include "stator/plant/motors/stepper_motor.hpp"

namespace stator::plant {

namespace {

std::vector<std::string_view> stepper_motor_names() {
  std::vector<std::string_view> names;
  for (const StepperMotorSheet& sheet : stepper_motor_sheets()) {
    names.push_back(sheet.name);
  }
  return names;
}

StepperMotorParameters known_stepper_motor(std::string_view name) {
  return *find_stepper_motor(name);
}

constexpr std::array kDriverRows{
    settings::number<&DriverStageParameters::on_resistance>(
        "on_resistance", {0.0, 10.0, "Ω"}, "Of the transistors in the path of a coil"),
    settings::keys<kStageThermalKeys, &DriverStageParameters::thermal>()};

constexpr settings::Section<DriverStageParameters> kDriverKeys{kDriverRows};

constexpr std::array kStepperAxisRows = settings::rows(
    std::array{
        settings::preset<stepper_motor_names, known_stepper_motor, &StepperAxisParameters::motor>(
            "motor", "Motor by name")},
    surroundings_rows<StepperAxisParameters>(),
    std::array{settings::section<kMotorThermalKeys, &StepperAxisParameters::motor,
                                 &StepperMotorParameters::thermal>("motor_thermal", "Of the motor"),
               settings::section<kDriverKeys, &StepperAxisParameters::driver>(
                   "driver", "Of the driver chip and its board")});

constexpr std::array kStepperAxisRules{brake_rule<StepperAxisParameters>()};

}  // namespace

constinit const settings::Section<StepperAxisParameters> kStepperAxisKeys{kStepperAxisRows,
                                                                          kStepperAxisRules};

}  // namespace stator::plant
