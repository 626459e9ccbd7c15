#include "stator/plant/keys/servo_axis_keys.hpp"

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "stator/plant/keys/surroundings_keys.hpp"
#include "stator/settings/words.hpp"

namespace stator::plant {

namespace {

/// A limit that is not exact in binary is still in range itself.
constexpr double kRounding = 1e-9;

std::vector<std::string_view> three_phase_motor_names() {
  std::vector<std::string_view> names;
  for (const ThreePhaseMotorSheet& sheet : three_phase_motor_sheets()) {
    names.push_back(sheet.name);
  }
  return names;
}

ThreePhaseMotorParameters known_three_phase_motor(std::string_view name) {
  return *find_three_phase_motor(name);
}

constexpr std::array kThreePhaseMotorRows{
    settings::whole<&ThreePhaseMotorParameters::pole_pairs>("pole_pairs", {1, 100}, "Of the motor"),
    settings::number<&ThreePhaseMotorParameters::resistance>("resistance", {1e-3, 1e3, "Ω"},
                                                             "Of a phase, line to star point"),
    settings::number<&ThreePhaseMotorParameters::direct_inductance>("direct_inductance",
                                                                    {1e-6, 1.0, "H"}, "Of a phase"),
    settings::number<&ThreePhaseMotorParameters::quadrature_inductance>(
        "quadrature_inductance", {1e-6, 1.0, "H"}, "Of a phase"),
    settings::number<&ThreePhaseMotorParameters::flux_linkage>(
        "flux_linkage", {1e-5, 10.0, "V s"},
        "Peak, per electrical radian; the torque constant is 3/2 pole pairs × this, per A peak"),
    settings::number<&ThreePhaseMotorParameters::back_emf, &BackEmfShape::trapezoidal_share>(
        "trapezoidal_share", {0.0, 1.0},
        "Of the EMF; 0: sinusoidal, 1: trapezoidal, between: a blend"),
    settings::degrees<&ThreePhaseMotorParameters::back_emf, &BackEmfShape::flat_top>(
        "flat_top", {0.0, 170.0, "electrical degrees"}, "Over which the trapezoid is flat"),
    settings::number<&ThreePhaseMotorParameters::cogging, 0, &CoggingHarmonic::amplitude>(
        "cogging_torque", {0.0, 100.0, "N m"}, "Amplitude"),
    settings::whole<&ThreePhaseMotorParameters::cogging, 0, &CoggingHarmonic::order>(
        "cogging_order", {1, 24}, "Periods per electrical period"),
    settings::number<&ThreePhaseMotorParameters::rotor_inertia>(
        "rotor_inertia", {1e-9, 10.0, "kg m²"}, "Of the rotor alone"),
    settings::number<&ThreePhaseMotorParameters::viscous_friction>(
        "viscous_friction", {0.0, 10.0, "N m s/rad"}, "Torque that grows with speed"),
    settings::number<&ThreePhaseMotorParameters::coulomb_friction>(
        "coulomb_friction", {0.0, 100.0, "N m"}, "Torque against any motion"),
    settings::number<&ThreePhaseMotorParameters::static_friction>(
        "static_friction", {0.0, 100.0, "N m"}, "Torque that holds the shaft at standstill"),
    settings::number<&ThreePhaseMotorParameters::rated_current>("rated_current", {1e-3, 1e3, "A"},
                                                                "Peak")};

constexpr std::array kThreePhaseMotorRules{settings::Rule<ThreePhaseMotorParameters>{
    "static_friction",
    [](const ThreePhaseMotorParameters& motor, const settings::Reader& /*reader*/) -> std::string {
      return motor.static_friction < motor.coulomb_friction
                 ? R"("static_friction" must not be below "coulomb_friction")"
                 : "";
    }}};

constexpr std::array kHalfBridgeRows{
    settings::number<&InverterParameters::on_resistance>("on_resistance", {0.0, 10.0, "Ω"},
                                                         "Of a transistor"),
    settings::number<&InverterParameters::dead_time>(
        "dead_time", {0.0, 1e-5, "s"},
        "That the stage does not compensate, at most a tenth of the PWM period"),
    settings::number<&InverterParameters::diode_drop>("diode_drop", {0.0, 5.0, "V"},
                                                      "Of a body diode"),
    settings::keys<kStageThermalKeys, &InverterParameters::thermal>()};

constexpr std::array kHalfBridgeRules{settings::Rule<InverterParameters>{
    "dead_time",
    [](const InverterParameters& inverter, const settings::Reader& /*reader*/) -> std::string {
      const double longest = 0.1 * (1.0 / inverter.pwm_frequency);
      return inverter.dead_time > longest * (1.0 + kRounding)
                 ? "\"dead_time\" must not exceed a tenth of the PWM period, " +
                       settings::number_text(longest, 3) + " s here"
                 : "";
    }}};

constexpr std::array kServoInverterRows =
    settings::rows(std::array{settings::number<&InverterParameters::pwm_frequency>(
                       "pwm_frequency", {1e3, 1e6, "Hz"}, "Of the power stage")},
                   kHalfBridgeRows);

constexpr std::array kHallRows{
    settings::boolean<&HallSensorParameters::fitted>("fitted", "false: the inputs read low"),
    settings::boolean<&HallSensorParameters::inverted>(
        "inverted", "Open-collector sensors that read the other way round"),
    settings::degrees<&HallSensorParameters::offset>(
        "offset", {-360.0, 360.0, "electrical degrees"}, "By which the sensors are turned forward"),
    settings::degrees<&HallSensorParameters::placement_error, 0>(
        "h1_error", {-25.0, 25.0, "electrical degrees"}, "By which it sits ahead of its place"),
    settings::degrees<&HallSensorParameters::placement_error, 1>(
        "h2_error", {-25.0, 25.0, "electrical degrees"}, "By which it sits ahead of its place"),
    settings::degrees<&HallSensorParameters::placement_error, 2>(
        "h3_error", {-25.0, 25.0, "electrical degrees"}, "By which it sits ahead of its place"),
    settings::degrees<&HallSensorParameters::hysteresis>(
        "hysteresis", {0.0, 25.0, "electrical degrees"},
        "From the middle to either switching point")};

constexpr std::array kCurrentSensingRows{
    settings::number<&CurrentSensingParameters::gain, 0>("gain_u", {0.0, 2.0},
                                                         "1 measures rightly"),
    settings::number<&CurrentSensingParameters::offset, 0>("offset_u", {-100.0, 100.0, "A"},
                                                           "What is measured without current"),
    settings::number<&CurrentSensingParameters::gain, 1>("gain_v", {0.0, 2.0},
                                                         "1 measures rightly"),
    settings::number<&CurrentSensingParameters::offset, 1>("offset_v", {-100.0, 100.0, "A"},
                                                           "What is measured without current"),
    settings::number<&CurrentSensingParameters::gain, 2>("gain_w", {0.0, 2.0},
                                                         "1 measures rightly"),
    settings::number<&CurrentSensingParameters::offset, 2>("offset_w", {-100.0, 100.0, "A"},
                                                           "What is measured without current"),
    settings::number<&CurrentSensingParameters::noise>("noise", {0.0, 100.0, "A"},
                                                       "Standard deviation of a measured current"),
    settings::number<&CurrentSensingParameters::resolution>(
        "resolution", {0.0, 100.0, "A"}, "Per step of the converter; 0: not quantised"),
    settings::number<&CurrentSensingParameters::range>("range", {1e-3, 1e6, "A"},
                                                       "At which the converter saturates")};

constexpr settings::Section<InverterParameters> kServoInverterKeys{kServoInverterRows,
                                                                   kHalfBridgeRules};
constexpr settings::Section<CurrentSensingParameters> kCurrentSensingKeys{kCurrentSensingRows};

constexpr std::array kServoAxisRows = settings::rows(
    std::array{
        settings::preset<three_phase_motor_names, known_three_phase_motor,
                         &ServoAxisParameters::motor>("motor", "Motor by name"),
        settings::section<kThreePhaseMotorKeys, &ServoAxisParameters::motor>(
            "motor_data", "Changes single values of the motor"),
        settings::section<kMotorThermalKeys, &ServoAxisParameters::motor,
                          &ThreePhaseMotorParameters::thermal>("motor_thermal", "Of the motor")},
    surroundings_rows<ServoAxisParameters>(),
    std::array{
        settings::section<kServoInverterKeys, &ServoAxisParameters::inverter>("inverter",
                                                                              "The power stage"),
        settings::section<kHallKeys, &ServoAxisParameters::halls>("halls", "The Hall sensors"),
        settings::section<kCurrentSensingKeys, &ServoAxisParameters::current_sensing>(
            "current_sensing", "How phase currents are measured")});

constexpr std::array kServoAxisRules{brake_rule<ServoAxisParameters>()};

}  // namespace

constinit const settings::Section<ThreePhaseMotorParameters> kThreePhaseMotorKeys{
    kThreePhaseMotorRows, kThreePhaseMotorRules};
constinit const settings::Section<InverterParameters> kHalfBridgeKeys{kHalfBridgeRows,
                                                                      kHalfBridgeRules};
constinit const settings::Section<HallSensorParameters> kHallKeys{kHallRows};
constinit const settings::Section<ServoAxisParameters> kServoAxisKeys{kServoAxisRows,
                                                                      kServoAxisRules};

}  // namespace stator::plant
