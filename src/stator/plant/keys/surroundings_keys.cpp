#include "stator/plant/keys/surroundings_keys.hpp"

#include <array>
#include <limits>
#include <string>

#include "stator/base/sim_time.hpp"

namespace stator::plant {

namespace {

constexpr std::array kLoadRows{
    settings::number<&MechanicalLoad::inertia>("inertia", {0.0, 10.0, "kg m²"},
                                               "At the motor shaft"),
    settings::number<&MechanicalLoad::viscous_friction>(
        "viscous_friction", {0.0, 10.0, "N m s/rad"}, "Torque that grows with speed"),
    settings::number<&MechanicalLoad::coulomb_friction>("coulomb_friction", {0.0, 1000.0, "N m"},
                                                        "Torque against any motion"),
    settings::number<&MechanicalLoad::constant_torque>(
        "constant_torque", {-1000.0, 1000.0, "N m"},
        "Positive drives the shaft forward, so a weight that is lifted forward is negative"),
    settings::number<&MechanicalLoad::unbalance_torque>(
        "unbalance_torque", {-1000.0, 1000.0, "N m"},
        "Amplitude a of a torque −a·sin(shaft angle)"),
    settings::number<&MechanicalLoad::brake_torque>(
        "brake_torque", {0.0, 1000.0, "N m"}, "The holding brake resists with; 0: none fitted"),
    settings::number<&MechanicalLoad::end_stop_minimum>(
        "end_stop_minimum", {-kFarAway, kFarAway, "revolutions"}, "Lower end of the travel"),
    settings::number<&MechanicalLoad::end_stop_maximum>(
        "end_stop_maximum", {-kFarAway, kFarAway, "revolutions"}, "Upper end of the travel"),
    settings::number<&MechanicalLoad::end_stop_stiffness>(
        "end_stop_stiffness", {0.1, 1e6, "N m/rad"}, "Of both end stops"),
    settings::number<&MechanicalLoad::end_stop_damping>(
        "end_stop_damping", {0.0, 100.0, "N m s/rad"}, "Of both end stops")};

constexpr std::array kLoadRules{settings::Rule<MechanicalLoad>{
    "end_stop_minimum",
    [](const MechanicalLoad& load, const settings::Reader& /*reader*/) -> std::string {
      return load.end_stop_minimum >= load.end_stop_maximum
                 ? R"("end_stop_minimum" must lie below "end_stop_maximum")"
                 : "";
    }}};

/// How long an armature may take.
constexpr settings::DurationRange kArmatureTimes{base::SimDuration(0),
                                                 base::SimDuration(10'000'000'000)};

constexpr std::array kBrakeRows{
    settings::whole<&HoldingBrake::output>(
        "output", {0, 3},
        "Output that feeds the coil of the brake; by default the own one of the axis"),
    settings::number<&HoldingBrake::pull_in_duty>(
        "pull_in", {0.01, 1.0}, "Mean voltage, as a fraction of full, from which the coil pulls"),
    settings::boolean<&HoldingBrake::closed_by_current>(
        "closed_by_current", "true: a power-on brake, closed by its coil; else a spring closes it"),
    settings::duration<&HoldingBrake::release_time>(
        "release_time", kArmatureTimes, "From switching the coil to the shaft being free"),
    settings::duration<&HoldingBrake::apply_time>(
        "apply_time", kArmatureTimes, "From switching the coil to the shaft being held")};

constexpr std::array kSupplyRows{
    settings::number<&SupplyParameters::capacitance>(
        "capacitance", {0.0, 1.0, "F"},
        "Of the capacitor at the power stage; 0: an ideal source, which also takes energy back"),
    settings::number<&SupplyParameters::source_resistance>(
        "source_resistance", {1e-3, 1e3, "Ω"},
        "Of source and cable; through it no energy goes back"),
    settings::number<&SupplyParameters::chopper_voltage>(
        "brake_chopper_voltage", {1.0, 1000.0, "V"},
        "From which a brake chopper burns what the motor returns; without one, braking harder than "
        "friction does raises the voltage until a servo drive switches off"),
    settings::number<&SupplyParameters::chopper_resistance>(
        "brake_chopper_resistance", {0.1, 1e4, "Ω"}, "Of the resistor of the brake chopper")};

constexpr std::array kMotorThermalRows{
    settings::number<&ThermalParameters::inner_capacity>("winding_capacity", {1e-3, 1e6, "J/K"},
                                                         "Heat capacity"),
    settings::number<&ThermalParameters::outer_capacity>("housing_capacity", {1e-3, 1e6, "J/K"},
                                                         "Heat capacity"),
    settings::number<&ThermalParameters::inner_to_outer>("winding_to_housing", {1e-3, 1e3, "K/W"},
                                                         "Thermal resistance"),
    settings::number<&ThermalParameters::outer_to_ambient>("housing_to_ambient", {1e-3, 1e3, "K/W"},
                                                           "Thermal resistance")};

constexpr std::array kStageThermalRows{
    settings::number<&ThermalParameters::inner_capacity>("chip_capacity", {1e-3, 1e6, "J/K"},
                                                         "Heat capacity"),
    settings::number<&ThermalParameters::outer_capacity>("board_capacity", {1e-3, 1e6, "J/K"},
                                                         "Heat capacity"),
    settings::number<&ThermalParameters::inner_to_outer>("chip_to_board", {1e-3, 1e3, "K/W"},
                                                         "Thermal resistance"),
    settings::number<&ThermalParameters::outer_to_ambient>("board_to_ambient", {1e-3, 1e3, "K/W"},
                                                           "Thermal resistance")};

constexpr std::array kEncoderRows{
    settings::whole<&EncoderParameters::counts_per_revolution>(
        "counts_per_revolution", {0, 1 << 24}, "After quadrature evaluation; 0: none fitted"),
    settings::boolean<&EncoderParameters::reversed>("reversed",
                                                    "Counts down when the shaft turns forward"),
    settings::number<&EncoderParameters::offset>("offset", {-1e9, 1e9, "counts"},
                                                 "By which the disc is turned against the shaft"),
    settings::whole<&EncoderParameters::index_position>(
        "index_position", {0, 1 << 24}, "Count within the revolution at which N is active"),
    settings::boolean<&EncoderParameters::index_active_low>(
        "index_active_low", "N is low at its pulse and high elsewhere")};

constexpr std::array kSwitchRows{
    settings::number<&PositionSwitch::pressed_from>("pressed_from",
                                                    {-kFarAway, kFarAway, "revolutions"},
                                                    "Where the switch begins to be pressed"),
    settings::number<&PositionSwitch::pressed_to>(
        "pressed_to", {-kFarAway, kFarAway, "revolutions"}, "Where it ends"),
    settings::boolean<&PositionSwitch::normally_closed>("normally_closed",
                                                        "The signal is low while pressed")};

constexpr std::array kSwitchRules{settings::Rule<PositionSwitch>{
    "pressed_from",
    [](const PositionSwitch& position_switch, const settings::Reader& /*reader*/) -> std::string {
      return position_switch.pressed_from > position_switch.pressed_to
                 ? R"("pressed_from" must not lie above "pressed_to")"
                 : "";
    }}};

void fit(PositionSwitch& position_switch) {
  position_switch.fitted = true;
  position_switch.pressed_from = -std::numeric_limits<double>::infinity();
  position_switch.pressed_to = std::numeric_limits<double>::infinity();
}

}  // namespace

constinit const settings::Section<MechanicalLoad> kLoadKeys{kLoadRows, kLoadRules};
constinit const settings::Section<HoldingBrake> kBrakeKeys{kBrakeRows};
constinit const settings::Section<SupplyParameters> kSupplyKeys{kSupplyRows};
constinit const settings::Section<ThermalParameters> kMotorThermalKeys{kMotorThermalRows};
constinit const settings::Section<ThermalParameters> kStageThermalKeys{kStageThermalRows};
constinit const settings::Section<EncoderParameters> kEncoderKeys{kEncoderRows};
constinit const settings::Section<PositionSwitch> kSwitchKeys{kSwitchRows, kSwitchRules, fit};

}  // namespace stator::plant
