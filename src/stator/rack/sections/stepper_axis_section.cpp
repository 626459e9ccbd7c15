#include "stator/rack/sections/stepper_axis_section.hpp"

#include <set>
#include <string>

#include <fmt/format.h>

#include "stator/rack/sections/axis_sections.hpp"

namespace stator::rack {

namespace {

std::set<std::string> motor_names() {
  std::set<std::string> names;
  for (const plant::StepperMotorSheet& sheet : plant::stepper_motor_sheets()) {
    names.emplace(sheet.name);
  }
  return names;
}

void read_driver(TomlSection section, plant::DriverStageParameters& driver) {
  set(section, {"on_resistance", "Of the transistors in the path of a coil", "Ω"}, 0.0, 10.0,
      driver.on_resistance);
  set(section, {"chip_capacity", "Heat capacity", "J/K"}, 1e-3, 1e6, driver.thermal.inner_capacity);
  set(section, {"board_capacity", "Heat capacity", "J/K"}, 1e-3, 1e6,
      driver.thermal.outer_capacity);
  set(section, {"chip_to_board", "Thermal resistance", "K/W"}, 1e-3, 1e3,
      driver.thermal.inner_to_outer);
  set(section, {"board_to_ambient", "Thermal resistance", "K/W"}, 1e-3, 1e3,
      driver.thermal.outer_to_ambient);
  section.finish();
}

}  // namespace

void read_stepper_axis(TomlSection& section, plant::StepperAxisParameters& parameters) {
  if (const auto name = section.choice({"motor", "Motor by name"}, motor_names())) {
    parameters.motor = *plant::find_stepper_motor(*name);
  }
  read_axis_surroundings(section, parameters);
  if (auto thermal = section.section({"motor_thermal", "Of the motor"})) {
    read_motor_thermal(*thermal, parameters.motor.thermal);
  }
  if (auto driver = section.section({"driver", "Of the driver chip and its board"})) {
    read_driver(*driver, parameters.driver);
  }
  section.finish();
}

}  // namespace stator::rack
