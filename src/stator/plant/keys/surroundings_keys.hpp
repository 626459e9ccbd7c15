#pragma once

#include <array>
#include <string>

#include "stator/plant/mechanics/holding_brake.hpp"
#include "stator/plant/mechanics/mechanical_load.hpp"
#include "stator/plant/motors/two_body_thermal.hpp"
#include "stator/plant/power/supply.hpp"
#include "stator/plant/sensors/incremental_encoder.hpp"
#include "stator/plant/sensors/position_switch.hpp"
#include "stator/settings/key.hpp"

namespace stator::plant {

// The keys that axes of every kind of motor have, docs/rack-file.md.

/// Beyond it a position is surely a mistake, revolutions.
inline constexpr double kFarAway = 1e6;

extern const settings::Section<MechanicalLoad> kLoadKeys;
extern const settings::Section<HoldingBrake> kBrakeKeys;
extern const settings::Section<SupplyParameters> kSupplyKeys;
/// Winding and housing of a motor.
extern const settings::Section<ThermalParameters> kMotorThermalKeys;
/// Chip and board of a power stage.
extern const settings::Section<ThermalParameters> kStageThermalKeys;
extern const settings::Section<EncoderParameters> kEncoderKeys;
/// Being named, a switch is fitted; it is pressed everywhere unless its keys say where.
extern const settings::Section<PositionSwitch> kSwitchKeys;

/// What the inputs of all switches read if none is fitted.
template <typename Parameters>
void read_open_inputs(const settings::KeyWords& key, settings::Reader& reader,
                      Parameters& parameters) {
  if (const auto high = reader.boolean(key)) {
    parameters.left_switch.level_if_not_fitted = *high;
    parameters.right_switch.level_if_not_fitted = *high;
    parameters.home_switch.level_if_not_fitted = *high;
  }
}

/// What surrounds a motor: supply, load, brake and switches; `Parameters` is StepperAxisParameters,
/// ServoAxisParameters or PwmAxisParameters. They need brake_rule() as well.
template <typename Parameters>
constexpr auto mechanics_rows() {
  using P = Parameters;
  return std::array{
      settings::number<&P::supply_voltage>("supply_voltage", {0.0, 100.0, "V"},
                                           "Of the power stage"),
      settings::number<&P::initial_revolutions>("initial_position",
                                                {-kFarAway, kFarAway, "revolutions"},
                                                "At which the shaft stands at power-on"),
      settings::number<&P::ambient_temperature>("ambient_temperature", {-50.0, 200.0, "°C"},
                                                "Motor and driver start with it"),
      settings::section<kSupplyKeys, &P::supply>("supply", "The supply of the power stage"),
      settings::section<kLoadKeys, &P::load>("load", "What hangs at the shaft"),
      settings::section<kBrakeKeys, &P::brake>("brake", "The holding brake"),
      settings::custom<P, read_open_inputs<P>>(
          "open_inputs_high", "Switch inputs to which nothing is connected read high"),
      settings::section<kSwitchKeys, &P::left_switch>("left_switch", "Fitted if it is named"),
      settings::section<kSwitchKeys, &P::right_switch>("right_switch", "Fitted if it is named"),
      settings::section<kSwitchKeys, &P::home_switch>("home_switch", "Fitted if it is named")};
}

/// The same with the encoder of an axis that has one.
template <typename Parameters>
constexpr auto surroundings_rows() {
  return settings::rows(mechanics_rows<Parameters>(),
                        std::array{settings::section<kEncoderKeys, &Parameters::encoder>(
                            "encoder", "The incremental encoder at the shaft")});
}

/// A brake that is described holds something.
template <typename Parameters>
constexpr settings::Rule<Parameters> brake_rule() {
  return {"brake", [](const Parameters& parameters, const settings::Reader& reader) -> std::string {
            return reader.contains("brake") && parameters.load.brake_torque == 0.0
                       ? "a brake needs \"load.brake_torque\", the torque it holds with"
                       : "";
          }};
}

}  // namespace stator::plant
