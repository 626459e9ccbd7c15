#pragma once

#include <set>
#include <string>

#include "stator/plant/mechanics/holding_brake.hpp"
#include "stator/plant/mechanics/mechanical_load.hpp"
#include "stator/plant/motors/two_body_thermal.hpp"
#include "stator/plant/power/supply.hpp"
#include "stator/plant/sensors/incremental_encoder.hpp"
#include "stator/plant/sensors/position_switch.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

// The keys that axes of every kind of motor have, docs/rack-file.md. Each function reads a table
// over the values its target has and throws RackFileError for unknown keys and values out of range.

/// Beyond it a position is surely a mistake, revolutions.
inline constexpr double kFarAway = 1e6;

/// Replaces `target` by the number at `key`, if there is one.
inline void set(TomlSection& section, const TomlKey& key, double minimum, double maximum,
                double& target) {
  section.number(key, minimum, maximum, target);
}

/// The same for an angle, degrees in the file and radians in `target`.
void set_degrees(TomlSection& section, const TomlKey& key, double minimum, double maximum,
                 double& target);

void read_load(TomlSection section, plant::MechanicalLoad& load);
void read_brake(TomlSection section, plant::HoldingBrake& brake);
void read_supply(TomlSection section, plant::SupplyParameters& supply);
void read_motor_thermal(TomlSection section, plant::ThermalParameters& thermal);
void read_encoder(TomlSection section, plant::EncoderParameters& encoder);
void read_switch(TomlSection section, plant::PositionSwitch& position_switch);

/// What surrounds a motor: supply, load, brake and switches; `Parameters` is
/// plant::StepperAxisParameters, plant::ServoAxisParameters or plant::PwmAxisParameters.
template <typename Parameters>
void read_axis_mechanics(TomlSection& section, Parameters& parameters) {
  set(section, {"supply_voltage", "Of the power stage", "V"}, 0.0, 100.0,
      parameters.supply_voltage);
  set(section, {"initial_position", "At which the shaft stands at power-on", "revolutions"},
      -kFarAway, kFarAway, parameters.initial_revolutions);
  set(section, {"ambient_temperature", "Motor and driver start with it", "°C"}, -50.0, 200.0,
      parameters.ambient_temperature);
  if (auto supply = section.section({"supply", "The supply of the power stage"})) {
    read_supply(*supply, parameters.supply);
  }
  if (auto load = section.section({"load", "What hangs at the shaft"})) {
    read_load(*load, parameters.load);
  }
  if (auto brake = section.section({"brake", "The holding brake"})) {
    if (parameters.load.brake_torque == 0.0) {
      section.refuse("brake", "a brake needs \"load.brake_torque\", the torque it holds with");
    }
    read_brake(*brake, parameters.brake);
  }
  if (const auto high = section.boolean(
          {"open_inputs_high", "Switch inputs to which nothing is connected read high"})) {
    parameters.left_switch.level_if_not_fitted = *high;
    parameters.right_switch.level_if_not_fitted = *high;
    parameters.home_switch.level_if_not_fitted = *high;
  }
  if (auto left = section.section({"left_switch", "Fitted if it is named"})) {
    read_switch(*left, parameters.left_switch);
  }
  if (auto right = section.section({"right_switch", "Fitted if it is named"})) {
    read_switch(*right, parameters.right_switch);
  }
  if (auto home = section.section({"home_switch", "Fitted if it is named"})) {
    read_switch(*home, parameters.home_switch);
  }
}

/// The same with the encoder of an axis that has one.
template <typename Parameters>
void read_axis_surroundings(TomlSection& section, Parameters& parameters) {
  read_axis_mechanics(section, parameters);
  if (auto encoder = section.section({"encoder", "The incremental encoder at the shaft"})) {
    read_encoder(*encoder, parameters.encoder);
  }
}

}  // namespace stator::rack
