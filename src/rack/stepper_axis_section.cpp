#include "rack/stepper_axis_section.hpp"

#include <optional>
#include <set>
#include <string>

#include "rack/axis_sections.hpp"

namespace stator::rack {

namespace {

std::optional<plant::StepperMotorParameters> motor_named(TomlSection& section,
                                                         const std::string& name) {
  if (const auto motor = plant::find_stepper_motor(name)) {
    return motor;
  }
  std::set<std::string> names;
  for (const plant::StepperMotorSheet& sheet : plant::stepper_motor_sheets()) {
    names.emplace(sheet.name);
  }
  refuse_motor(section, name, names);
  return std::nullopt;
}

void read_driver(TomlSection section, plant::DriverStageParameters& driver) {
  set(section, "on_resistance", 0.0, 10.0, driver.on_resistance);
  set(section, "chip_capacity", 1e-3, 1e6, driver.thermal.inner_capacity);
  set(section, "board_capacity", 1e-3, 1e6, driver.thermal.outer_capacity);
  set(section, "chip_to_board", 1e-3, 1e3, driver.thermal.inner_to_outer);
  set(section, "board_to_ambient", 1e-3, 1e3, driver.thermal.outer_to_ambient);
  section.finish();
}

}  // namespace

void read_stepper_axis(TomlSection& section, plant::StepperAxisParameters& parameters) {
  if (const auto name = section.text("motor")) {
    parameters.motor = motor_named(section, *name).value_or(parameters.motor);
  }
  read_axis_surroundings(section, parameters);
  if (auto thermal = section.section("motor_thermal")) {
    read_motor_thermal(*thermal, parameters.motor.thermal);
  }
  if (auto driver = section.section("driver")) {
    read_driver(*driver, parameters.driver);
  }
  section.finish();
}

}  // namespace stator::rack
