#include "stator/plant/keys/pwm_axis_keys.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "stator/plant/keys/servo_axis_keys.hpp"
#include "stator/plant/keys/surroundings_keys.hpp"
#include "stator/plant/motors/dc_motor.hpp"
#include "stator/plant/motors/stepper_motor.hpp"

namespace stator::plant {

namespace {

/// The name of a brushed motor: there is no catalogue of them, motor_data says what it is.
constexpr std::string_view kDirectCurrent = "dc";

std::vector<std::string_view> pwm_motor_names() {
  std::vector<std::string_view> names{kDirectCurrent};
  for (const ThreePhaseMotorSheet& sheet : three_phase_motor_sheets()) {
    names.push_back(sheet.name);
  }
  for (const StepperMotorSheet& sheet : stepper_motor_sheets()) {
    names.push_back(sheet.name);
  }
  return names;
}

MotorParameters pwm_motor_named(std::string_view name) {
  if (const auto motor = find_three_phase_motor(name)) {
    return *motor;
  }
  if (const auto motor = find_stepper_motor(name)) {
    return *motor;
  }
  return DcMotorParameters{};
}

/// Per revolution of the shaft: they see the magnets of the motor.
int analog_hall_periods(const MotorParameters& motor) {
  if (const auto* three_phase = std::get_if<ThreePhaseMotorParameters>(&motor)) {
    return three_phase->pole_pairs;
  }
  const auto* stepper = std::get_if<StepperMotorParameters>(&motor);
  return stepper != nullptr ? stepper->pole_pairs : 1;
}

constexpr std::array kTwoPhaseMotorRows{
    settings::number<&StepperMotorParameters::resistance>("resistance", {1e-3, 1e3, "Ω"},
                                                          "Of the winding"),
    settings::number<&StepperMotorParameters::inductance>("inductance", {1e-6, 1.0, "H"},
                                                          "Of the winding"),
    settings::number<&StepperMotorParameters::rotor_inertia>("rotor_inertia", {1e-9, 10.0, "kg m²"},
                                                             "Of the rotor alone"),
    settings::number<&StepperMotorParameters::rated_current>("rated_current", {1e-3, 1e3, "A"},
                                                             "Of the winding")};

constexpr std::array kDcMotorRows{
    settings::number<&DcMotorParameters::resistance>("resistance", {1e-3, 1e3, "Ω"},
                                                     "Of the winding"),
    settings::number<&DcMotorParameters::inductance>("inductance", {1e-6, 1.0, "H"},
                                                     "Of the winding"),
    settings::number<&DcMotorParameters::torque_constant>("torque_constant", {1e-5, 10.0, "N m/A"},
                                                          "Torque per current"),
    settings::number<&DcMotorParameters::rotor_inertia>("rotor_inertia", {1e-9, 10.0, "kg m²"},
                                                        "Of the rotor alone"),
    settings::number<&DcMotorParameters::viscous_friction>(
        "viscous_friction", {0.0, 10.0, "N m s/rad"}, "Torque that grows with speed"),
    settings::number<&DcMotorParameters::coulomb_friction>("coulomb_friction", {0.0, 100.0, "N m"},
                                                           "Torque against any motion"),
    settings::number<&DcMotorParameters::static_friction>(
        "static_friction", {0.0, 100.0, "N m"}, "Torque that holds the shaft at standstill"),
    settings::number<&DcMotorParameters::rated_current>("rated_current", {1e-3, 1e3, "A"},
                                                        "Of the winding")};

constexpr std::array kDcMotorRules{settings::Rule<DcMotorParameters>{
    "static_friction",
    [](const DcMotorParameters& motor, const settings::Reader& /*reader*/) -> std::string {
      return motor.static_friction < motor.coulomb_friction
                 ? R"("static_friction" must not be below "coulomb_friction")"
                 : "";
    }}};

constexpr settings::Section<StepperMotorParameters> kTwoPhaseMotorKeys{kTwoPhaseMotorRows};
constexpr settings::Section<DcMotorParameters> kDcMotorKeys{kDcMotorRows, kDcMotorRules};

/// Motors of all kinds have it.
void read_motor_thermal(const settings::KeyWords& key, settings::Reader& reader,
                        PwmAxisParameters& parameters) {
  if (auto table = reader.section(key)) {
    std::visit(
        [&](auto& motor) { settings::read_section(kMotorThermalKeys, *table, motor.thermal); },
        parameters.motor);
  }
}

constexpr std::array kInverterModels{
    settings::Word{"averaged", static_cast<std::int64_t>(InverterModel::averaged)},
    settings::Word{"switched", static_cast<std::int64_t>(InverterModel::switched)}};

constexpr std::array kPwmInverterRows{
    settings::word<&PwmAxisParameters::inverter_model>(
        "model", kInverterModels,
        "switched: every edge is simulated, with the ripple of currents and supply"),
    settings::keys<kHalfBridgeKeys, &PwmAxisParameters::inverter>()};

/// A key of other axes, which is none here: it is refused with more than that.
constexpr std::array kPwmInverterRules{settings::Rule<PwmAxisParameters>{
    "pwm_frequency",
    [](const PwmAxisParameters& /*parameters*/, const settings::Reader& reader) -> std::string {
      return reader.contains("pwm_frequency")
                 ? "\"pwm_frequency\" is not the inverter's here: the chip makes the PWM; set it "
                   "with [segment.device.objects], \"2001:01\" = 3999 for 25 kHz"
                 : "";
    }}};

constexpr settings::Section<PwmAxisParameters> kPwmInverterKeys{kPwmInverterRows,
                                                                kPwmInverterRules};

/// The table tells about the inverter and about how it is simulated.
void read_pwm_inverter(const settings::KeyWords& key, settings::Reader& reader,
                       PwmAxisParameters& parameters) {
  if (auto table = reader.section(key)) {
    settings::read_section(kPwmInverterKeys, *table, parameters);
  }
}

constexpr std::array kChannelRows{
    settings::number<&ConverterChannel::gain>(
        "gain", {-1e5, 1e5}, "Counts per A or V; negative: the amplifier is reversed"),
    settings::number<&ConverterChannel::offset>("offset", {0.0, 65535.0}, "Counts at 0 A or 0 V"),
    settings::number<&ConverterChannel::noise>("noise", {0.0, 65535.0, "counts"},
                                               "Standard deviation of a sample"),
    settings::number<&ConverterChannel::drift>("drift", {-1e3, 1e3, "counts/K"}, "Above 25 °C")};

constexpr std::array kChannelRules{settings::Rule<ConverterChannel>{
    "gain", [](const ConverterChannel& channel, const settings::Reader& /*reader*/) -> std::string {
      return channel.gain == 0.0 ? "\"gain\" must not be 0" : "";
    }}};

constexpr settings::Section<ConverterChannel> kChannelKeys{kChannelRows, kChannelRules};

constexpr std::array kConverterRows{
    settings::whole<&ConverterParameters::bits>(
        "bits", {8, 16}, "Effective bits of the converters; the lower ones read 0"),
    settings::number<&ConverterParameters::delay>(
        "delay", {0.0, 1e-3, "s"},
        "By which a filter of delta-sigma modulators delays its values, up to a PWM period"),
    settings::section<kChannelKeys, &ConverterParameters::currents, 0>("current_u",
                                                                       "Converter of phase U"),
    settings::section<kChannelKeys, &ConverterParameters::currents, 1>("current_w",
                                                                       "Converter of phase W"),
    settings::section<kChannelKeys, &ConverterParameters::voltage>(
        "voltage", "Converter of the supply voltage")};

constexpr settings::Section<ConverterParameters> kConverterKeys{kConverterRows};

constexpr std::array kDisturbanceRows{
    settings::degrees<&EncoderDisturbanceParameters::eccentricity>(
        "eccentricity", {0.0, 10.0, "degrees of the shaft"}, "Of the disc"),
    settings::degrees<&EncoderDisturbanceParameters::eccentricity_phase>(
        "eccentricity_phase", {-360.0, 360.0, "degrees of the shaft"},
        "Where the eccentricity acts"),
    settings::number<&EncoderDisturbanceParameters::missed_edge_probability>(
        "missed_edges", {0.0, 1.0}, "Probability per edge"),
    settings::number<&EncoderDisturbanceParameters::extra_edge_probability>(
        "extra_edges", {0.0, 1.0}, "Probability per edge"),
    settings::number<&EncoderDisturbanceParameters::highest_frequency>(
        "highest_frequency", {1.0, 1e9, "counts/s"}, "Beyond which counts get lost")};

constexpr settings::Section<EncoderDisturbanceParameters> kDisturbanceKeys{kDisturbanceRows};

constexpr std::array kTrackRows{
    settings::number<&AnalogTrack::amplitude>("amplitude", {0.0, 65535.0, "counts"},
                                              "Of the track"),
    settings::number<&AnalogTrack::offset>("offset", {0.0, 65535.0, "counts"},
                                           "Middle of the track"),
    settings::degrees<&AnalogTrack::phase>("phase", {-360.0, 360.0, "degrees"},
                                           "By which the track is turned"),
    settings::number<&AnalogTrack::second_harmonic>("second_harmonic", {-1.0, 1.0},
                                                    "Share of the amplitude"),
    settings::number<&AnalogTrack::third_harmonic>("third_harmonic", {-1.0, 1.0},
                                                   "Share of the amplitude")};

constexpr settings::Section<AnalogTrack> kTrackKeys{kTrackRows};

/// Without a default: no sensor is fitted unless the table is there.
void read_periods(const settings::KeyWords& key, settings::Reader& reader,
                  AnalogSensorParameters& sensor) {
  if (const auto periods = reader.integer(key, 1, 32767)) {
    sensor.periods_per_revolution = static_cast<int>(*periods);
  }
}

/// Of sensors with two tracks and with three.
constexpr std::array kTwoTrackRows{
    settings::number<&AnalogSensorParameters::noise>("noise", {0.0, 65535.0, "counts"},
                                                     "Standard deviation of a sample"),
    settings::section<kTrackKeys, &AnalogSensorParameters::track, 0>("track_1", "One analog track"),
    settings::section<kTrackKeys, &AnalogSensorParameters::track, 1>("track_2",
                                                                     "One analog track")};

constexpr std::array kAnalogEncoderRows =
    settings::rows(std::array{settings::custom<AnalogSensorParameters, read_periods>(
                       "periods_per_revolution", "Of the sine/cosine encoder")},
                   kTwoTrackRows);

constexpr std::array kAnalogHallRows = settings::rows(
    kTwoTrackRows, std::array{settings::section<kTrackKeys, &AnalogSensorParameters::track, 2>(
                       "track_3", "One analog track")});

void fit_analog_encoder(AnalogSensorParameters& sensor) {
  sensor = sine_cosine_encoder(1);
}

constexpr settings::Section<AnalogSensorParameters> kAnalogEncoderKeys{
    kAnalogEncoderRows, {}, fit_analog_encoder};
constexpr settings::Section<AnalogSensorParameters> kAnalogHallKeys{kAnalogHallRows};

/// Fitted if it is named; the motor's magnets are their scale.
void read_analog_halls(const settings::KeyWords& key, settings::Reader& reader,
                       PwmAxisParameters& parameters) {
  if (auto table = reader.section(key)) {
    parameters.analog_halls = analog_halls(analog_hall_periods(parameters.motor));
    settings::read_section(kAnalogHallKeys, *table, parameters.analog_halls);
  }
}

constexpr std::array kPwmAxisRows = settings::rows(
    std::array{
        settings::preset<pwm_motor_names, pwm_motor_named, &PwmAxisParameters::motor>(
            "motor",
            "Motor by name; dc: a brushed motor on the first bridge, which motor_data describes"),
        settings::alternatives<&PwmAxisParameters::motor, kThreePhaseMotorKeys, kDcMotorKeys,
                               kTwoPhaseMotorKeys>(
            "motor_data", "Changes single values of the motor; keys depend on its kind"),
        settings::custom<PwmAxisParameters, read_motor_thermal>("motor_thermal", "Of the motor")},
    mechanics_rows<PwmAxisParameters>(),
    std::array{
        settings::custom<PwmAxisParameters, read_pwm_inverter>("inverter", "The power stage"),
        settings::section<kHallKeys, &PwmAxisParameters::halls>("halls", "The Hall sensors"),
        settings::section<kConverterKeys, &PwmAxisParameters::converter>(
            "converter", "The analog-to-digital converters"),
        settings::section<kEncoderKeys, &PwmAxisParameters::encoders, 0>(
            "encoder", "An incremental encoder at the shaft"),
        settings::section<kDisturbanceKeys, &PwmAxisParameters::encoder_disturbances, 0>(
            "encoder_disturbance", "What is wrong with that encoder"),
        settings::section<kEncoderKeys, &PwmAxisParameters::encoders, 1>(
            "encoder_2", "An incremental encoder at the shaft"),
        settings::section<kDisturbanceKeys, &PwmAxisParameters::encoder_disturbances, 1>(
            "encoder_2_disturbance", "What is wrong with that encoder"),
        settings::section<kAnalogEncoderKeys, &PwmAxisParameters::analog_encoder>(
            "analog_encoder", "A sine/cosine encoder"),
        settings::custom<PwmAxisParameters, read_analog_halls>(
            "analog_halls", "Analog Hall sensors with the motor's pole pairs"),
        settings::whole<&PwmAxisParameters::noise_seed>("noise_seed", {0, INT64_MAX},
                                                        "Of everything random around the axis")});

constexpr std::array kPwmAxisRules{brake_rule<PwmAxisParameters>()};

}  // namespace

constinit const settings::Section<PwmAxisParameters> kPwmAxisKeys{kPwmAxisRows, kPwmAxisRules};

}  // namespace stator::plant
