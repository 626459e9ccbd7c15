#include "stator/rack/sections/pwm_axis_section.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "stator/rack/sections/axis_sections.hpp"
#include "stator/rack/sections/servo_axis_section.hpp"

namespace stator::rack {

namespace {

/// The name of a brushed motor: there is no catalogue of them, motor_data says what it is.
constexpr const char* kDirectCurrent = "dc";

plant::MotorParameters motor_named(const std::string& name) {
  if (const auto motor = plant::find_three_phase_motor(name)) {
    return *motor;
  }
  if (const auto motor = plant::find_stepper_motor(name)) {
    return *motor;
  }
  return plant::DcMotorParameters{};
}

std::set<std::string> motor_names() {
  std::set<std::string> names{kDirectCurrent};
  for (const plant::ThreePhaseMotorSheet& sheet : plant::three_phase_motor_sheets()) {
    names.emplace(sheet.name);
  }
  for (const plant::StepperMotorSheet& sheet : plant::stepper_motor_sheets()) {
    names.emplace(sheet.name);
  }
  return names;
}

void read_motor_data(TomlSection section, plant::ThreePhaseMotorParameters& motor) {
  read_three_phase_motor(std::move(section), motor);
}

void read_motor_data(TomlSection section, plant::StepperMotorParameters& motor) {
  set(section, {"resistance", "Of the winding", "Ω"}, 1e-3, 1e3, motor.resistance);
  set(section, {"inductance", "Of the winding", "H"}, 1e-6, 1.0, motor.inductance);
  set(section, {"rotor_inertia", "Of the rotor alone", "kg m²"}, 1e-9, 10.0, motor.rotor_inertia);
  set(section, {"rated_current", "Of the winding", "A"}, 1e-3, 1e3, motor.rated_current);
  section.finish();
}

void read_motor_data(TomlSection section, plant::DcMotorParameters& motor) {
  set(section, {"resistance", "Of the winding", "Ω"}, 1e-3, 1e3, motor.resistance);
  set(section, {"inductance", "Of the winding", "H"}, 1e-6, 1.0, motor.inductance);
  set(section, {"torque_constant", "Torque per current", "N m/A"}, 1e-5, 10.0,
      motor.torque_constant);
  set(section, {"rotor_inertia", "Of the rotor alone", "kg m²"}, 1e-9, 10.0, motor.rotor_inertia);
  set(section, {"viscous_friction", "Torque that grows with speed", "N m s/rad"}, 0.0, 10.0,
      motor.viscous_friction);
  set(section, {"coulomb_friction", "Torque against any motion", "N m"}, 0.0, 100.0,
      motor.coulomb_friction);
  set(section, {"static_friction", "Torque that holds the shaft at standstill", "N m"}, 0.0, 100.0,
      motor.static_friction);
  set(section, {"rated_current", "Of the winding", "A"}, 1e-3, 1e3, motor.rated_current);
  if (motor.static_friction < motor.coulomb_friction) {
    section.refuse("static_friction", R"("static_friction" must not be below "coulomb_friction")");
  }
  section.finish();
}

void read_channel(TomlSection section, plant::ConverterChannel& channel) {
  set(section, {"gain", "Counts per A or V; negative: the amplifier is reversed"}, -1e5, 1e5,
      channel.gain);
  set(section, {"offset", "Counts at 0 A or 0 V"}, 0.0, 65535.0, channel.offset);
  set(section, {"noise", "Standard deviation of a sample", "counts"}, 0.0, 65535.0, channel.noise);
  set(section, {"drift", "Above 25 °C", "counts/K"}, -1e3, 1e3, channel.drift);
  if (channel.gain == 0.0) {
    section.refuse("gain", "\"gain\" must not be 0");
  }
  section.finish();
}

void read_converter(TomlSection section, plant::ConverterParameters& converter) {
  section.integer({"bits", "Effective bits of the converters; the lower ones read 0"}, 8, 16,
                  converter.bits);
  set(section,
      {"delay", "By which a filter of delta-sigma modulators delays its values, up to a PWM period",
       "s"},
      0.0, 1e-3, converter.delay);
  if (auto channel = section.section({"current_u", "Converter of phase U"})) {
    read_channel(*channel, converter.currents[0]);
  }
  if (auto channel = section.section({"current_w", "Converter of phase W"})) {
    read_channel(*channel, converter.currents[1]);
  }
  if (auto channel = section.section({"voltage", "Converter of the supply voltage"})) {
    read_channel(*channel, converter.voltage);
  }
  section.finish();
}

void read_track(TomlSection section, plant::AnalogTrack& track) {
  set(section, {"amplitude", "Of the track", "counts"}, 0.0, 65535.0, track.amplitude);
  set(section, {"offset", "Middle of the track", "counts"}, 0.0, 65535.0, track.offset);
  set_degrees(section, {"phase", "By which the track is turned", "degrees"}, -360.0, 360.0,
              track.phase);
  set(section, {"second_harmonic", "Share of the amplitude"}, -1.0, 1.0, track.second_harmonic);
  set(section, {"third_harmonic", "Share of the amplitude"}, -1.0, 1.0, track.third_harmonic);
  section.finish();
}

void read_analog_sensor(TomlSection section, plant::AnalogSensorParameters& sensor) {
  constexpr std::array kTracks{"track_1", "track_2", "track_3"};
  set(section, {"noise", "Standard deviation of a sample", "counts"}, 0.0, 65535.0, sensor.noise);
  for (std::size_t i = 0; i < sensor.tracks; ++i) {
    if (auto track = section.section({kTracks[i], "One analog track"})) {
      read_track(*track, sensor.track[i]);
    }
  }
  section.finish();
}

void read_disturbance(TomlSection section, plant::EncoderDisturbanceParameters& disturbance) {
  set_degrees(section, {"eccentricity", "Of the disc", "degrees of the shaft"}, 0.0, 10.0,
              disturbance.eccentricity);
  set_degrees(section,
              {"eccentricity_phase", "Where the eccentricity acts", "degrees of the shaft"}, -360.0,
              360.0, disturbance.eccentricity_phase);
  set(section, {"missed_edges", "Probability per edge"}, 0.0, 1.0,
      disturbance.missed_edge_probability);
  set(section, {"extra_edges", "Probability per edge"}, 0.0, 1.0,
      disturbance.extra_edge_probability);
  set(section, {"highest_frequency", "Beyond which counts get lost", "counts/s"}, 1.0, 1e9,
      disturbance.highest_frequency);
  section.finish();
}

int pole_pairs_of(const plant::MotorParameters& motor) {
  if (const auto* three_phase = std::get_if<plant::ThreePhaseMotorParameters>(&motor)) {
    return three_phase->pole_pairs;
  }
  const auto* stepper = std::get_if<plant::StepperMotorParameters>(&motor);
  return stepper != nullptr ? stepper->pole_pairs : 1;
}

void read_encoders(TomlSection& section, plant::PwmAxisParameters& parameters) {
  constexpr std::array kEncoders{"encoder", "encoder_2"};
  constexpr std::array kDisturbances{"encoder_disturbance", "encoder_2_disturbance"};
  for (std::size_t i = 0; i < kEncoders.size(); ++i) {
    if (auto encoder = section.section({kEncoders[i], "An incremental encoder at the shaft"})) {
      read_encoder(*encoder, parameters.encoders[i]);
    }
    if (auto disturbance = section.section({kDisturbances[i], "What is wrong with that encoder"})) {
      read_disturbance(*disturbance, parameters.encoder_disturbances[i]);
    }
  }
  if (auto analog = section.section({"analog_encoder", "A sine/cosine encoder"})) {
    const auto periods =
        analog->integer({"periods_per_revolution", "Of the sine/cosine encoder"}, 1, 32767);
    parameters.analog_encoder = plant::sine_cosine_encoder(static_cast<int>(periods.value_or(1)));
    read_analog_sensor(*analog, parameters.analog_encoder);
  }
  if (auto analog =
          section.section({"analog_halls", "Analog Hall sensors with the motor's pole pairs"})) {
    parameters.analog_halls = plant::analog_halls(pole_pairs_of(parameters.motor));
    read_analog_sensor(*analog, parameters.analog_halls);
  }
}

void read_inverter(TomlSection section, double pwm_period, plant::PwmAxisParameters& parameters) {
  section.choice(
      {"model", "switched: every edge is simulated, with the ripple of currents and supply"},
      {{"averaged", plant::InverterModel::averaged}, {"switched", plant::InverterModel::switched}},
      parameters.inverter_model);
  constexpr const char* kFrequency = "pwm_frequency";
  if (section.contains(kFrequency)) {
    section.fail(
        kFrequency,
        "\"pwm_frequency\" is not the inverter's here: the chip makes the PWM; set it with "
        "[segment.device.objects], \"2001:01\" = 3999 for 25 kHz");
  }
  read_half_bridges(section, pwm_period, parameters.inverter);
}

}  // namespace

void read_pwm_axis(TomlSection& section, double pwm_period, plant::PwmAxisParameters& parameters) {
  if (const auto name = section.choice(
          {"motor",
           "Motor by name; dc: a brushed motor on the first bridge, which motor_data describes"},
          motor_names())) {
    parameters.motor = motor_named(*name);
  }
  if (auto data = section.section(
          {"motor_data", "Changes single values of the motor; keys depend on its kind"})) {
    std::visit([&](auto& motor) { read_motor_data(*data, motor); }, parameters.motor);
  }
  if (auto thermal = section.section({"motor_thermal", "Of the motor"})) {
    std::visit([&](auto& motor) { read_motor_thermal(*thermal, motor.thermal); }, parameters.motor);
  }
  read_axis_mechanics(section, parameters);
  if (auto inverter = section.section({"inverter", "The power stage"})) {
    read_inverter(*inverter, pwm_period, parameters);
  }
  if (auto halls = section.section({"halls", "The Hall sensors"})) {
    read_halls(*halls, parameters.halls);
  }
  if (auto converter = section.section({"converter", "The analog-to-digital converters"})) {
    read_converter(*converter, parameters.converter);
  }
  read_encoders(section, parameters);
  section.integer({"noise_seed", "Of everything random around the axis"}, 0, INT64_MAX,
                  parameters.noise_seed);
  section.finish();
}

}  // namespace stator::rack
