#include "rack/pwm_axis_section.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "base/trigonometry.hpp"
#include "rack/axis_sections.hpp"
#include "rack/servo_axis_section.hpp"

namespace stator::rack {

namespace {

constexpr double kDegree = base::kPi / 180.0;
/// The name of a brushed motor: there is no catalogue of them, motor_data says what it is.
constexpr const char* kDirectCurrent = "dc";

std::optional<plant::MotorParameters> motor_named(TomlSection& section, const std::string& name) {
  if (name == kDirectCurrent) {
    return plant::DcMotorParameters{};
  }
  if (const auto motor = plant::find_three_phase_motor(name)) {
    return *motor;
  }
  if (const auto motor = plant::find_stepper_motor(name)) {
    return *motor;
  }
  std::set<std::string> names{kDirectCurrent};
  for (const plant::ThreePhaseMotorSheet& sheet : plant::three_phase_motor_sheets()) {
    names.emplace(sheet.name);
  }
  for (const plant::StepperMotorSheet& sheet : plant::stepper_motor_sheets()) {
    names.emplace(sheet.name);
  }
  refuse_motor(section, name, names);
  return std::nullopt;
}

void read_motor_data(TomlSection section, plant::ThreePhaseMotorParameters& motor) {
  read_three_phase_motor(std::move(section), motor);
}

void read_motor_data(TomlSection section, plant::StepperMotorParameters& motor) {
  set(section, "resistance", 1e-3, 1e3, motor.resistance);
  set(section, "inductance", 1e-6, 1.0, motor.inductance);
  set(section, "rotor_inertia", 1e-9, 10.0, motor.rotor_inertia);
  set(section, "rated_current", 1e-3, 1e3, motor.rated_current);
  section.finish();
}

void read_motor_data(TomlSection section, plant::DcMotorParameters& motor) {
  set(section, "resistance", 1e-3, 1e3, motor.resistance);
  set(section, "inductance", 1e-6, 1.0, motor.inductance);
  set(section, "torque_constant", 1e-5, 10.0, motor.torque_constant);
  set(section, "rotor_inertia", 1e-9, 10.0, motor.rotor_inertia);
  set(section, "viscous_friction", 0.0, 10.0, motor.viscous_friction);
  set(section, "coulomb_friction", 0.0, 100.0, motor.coulomb_friction);
  set(section, "static_friction", 0.0, 100.0, motor.static_friction);
  set(section, "rated_current", 1e-3, 1e3, motor.rated_current);
  if (motor.static_friction < motor.coulomb_friction) {
    section.refuse("static_friction", R"("static_friction" must not be below "coulomb_friction")");
  }
  section.finish();
}

void read_channel(TomlSection section, plant::ConverterChannel& channel) {
  set(section, "gain", -1e5, 1e5, channel.gain);
  set(section, "offset", 0.0, 65535.0, channel.offset);
  set(section, "noise", 0.0, 65535.0, channel.noise);
  set(section, "drift", -1e3, 1e3, channel.drift);
  if (channel.gain == 0.0) {
    section.refuse("gain", "\"gain\" must not be 0");
  }
  section.finish();
}

void read_converter(TomlSection section, plant::ConverterParameters& converter) {
  converter.bits = static_cast<int>(section.integer("bits", 8, 16).value_or(converter.bits));
  set(section, "delay", 0.0, 1e-3, converter.delay);
  if (auto channel = section.section("current_u")) {
    read_channel(*channel, converter.currents[0]);
  }
  if (auto channel = section.section("current_w")) {
    read_channel(*channel, converter.currents[1]);
  }
  if (auto channel = section.section("voltage")) {
    read_channel(*channel, converter.voltage);
  }
  section.finish();
}

void read_track(TomlSection section, plant::AnalogTrack& track) {
  set(section, "amplitude", 0.0, 65535.0, track.amplitude);
  set(section, "offset", 0.0, 65535.0, track.offset);
  if (const auto degrees = section.number("phase", -360.0, 360.0)) {
    track.phase = *degrees * kDegree;
  }
  set(section, "second_harmonic", -1.0, 1.0, track.second_harmonic);
  set(section, "third_harmonic", -1.0, 1.0, track.third_harmonic);
  section.finish();
}

void read_analog_sensor(TomlSection section, plant::AnalogSensorParameters& sensor) {
  constexpr std::array kTracks{"track_1", "track_2", "track_3"};
  set(section, "noise", 0.0, 65535.0, sensor.noise);
  for (std::size_t i = 0; i < sensor.tracks; ++i) {
    if (auto track = section.section(kTracks[i])) {
      read_track(*track, sensor.track[i]);
    }
  }
  section.finish();
}

void read_disturbance(TomlSection section, plant::EncoderDisturbanceParameters& disturbance) {
  if (const auto degrees = section.number("eccentricity", 0.0, 10.0)) {
    disturbance.eccentricity = *degrees * kDegree;
  }
  if (const auto degrees = section.number("eccentricity_phase", -360.0, 360.0)) {
    disturbance.eccentricity_phase = *degrees * kDegree;
  }
  set(section, "missed_edges", 0.0, 1.0, disturbance.missed_edge_probability);
  set(section, "extra_edges", 0.0, 1.0, disturbance.extra_edge_probability);
  set(section, "highest_frequency", 1.0, 1e9, disturbance.highest_frequency);
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
    if (auto encoder = section.section(kEncoders[i])) {
      read_encoder(*encoder, parameters.encoders[i]);
    }
    if (auto disturbance = section.section(kDisturbances[i])) {
      read_disturbance(*disturbance, parameters.encoder_disturbances[i]);
    }
  }
  if (auto analog = section.section("analog_encoder")) {
    const auto periods = analog->integer("periods_per_revolution", 1, 32767);
    parameters.analog_encoder = plant::sine_cosine_encoder(static_cast<int>(periods.value_or(1)));
    read_analog_sensor(*analog, parameters.analog_encoder);
  }
  if (auto analog = section.section("analog_halls")) {
    parameters.analog_halls = plant::analog_halls(pole_pairs_of(parameters.motor));
    read_analog_sensor(*analog, parameters.analog_halls);
  }
}

void read_inverter(TomlSection section, double pwm_period, plant::PwmAxisParameters& parameters) {
  if (const auto model = section.choice("model", {"averaged", "switched"})) {
    parameters.inverter_model =
        *model == "switched" ? plant::InverterModel::switched : plant::InverterModel::averaged;
  }
  constexpr const char* kFrequency = "pwm_frequency";
  const std::vector<std::string> keys = section.keys();
  if (std::ranges::find(keys, kFrequency) != keys.end()) {
    section.fail(
        kFrequency,
        "\"pwm_frequency\" is not the inverter's here: the chip makes the PWM; set it with "
        "[segment.device.objects], \"2001:01\" = 3999 for 25 kHz");
  }
  read_half_bridges(section, pwm_period, parameters.inverter);
}

}  // namespace

void read_pwm_axis(TomlSection& section, double pwm_period, plant::PwmAxisParameters& parameters) {
  if (const auto name = section.text("motor")) {
    parameters.motor = motor_named(section, *name).value_or(parameters.motor);
  }
  if (auto data = section.section("motor_data")) {
    std::visit([&](auto& motor) { read_motor_data(*data, motor); }, parameters.motor);
  }
  if (auto thermal = section.section("motor_thermal")) {
    std::visit([&](auto& motor) { read_motor_thermal(*thermal, motor.thermal); }, parameters.motor);
  }
  read_axis_mechanics(section, parameters);
  if (auto inverter = section.section("inverter")) {
    read_inverter(*inverter, pwm_period, parameters);
  }
  if (auto halls = section.section("halls")) {
    read_halls(*halls, parameters.halls);
  }
  if (auto converter = section.section("converter")) {
    read_converter(*converter, parameters.converter);
  }
  read_encoders(section, parameters);
  if (const auto seed = section.integer("noise_seed", 0, INT64_MAX)) {
    parameters.noise_seed = static_cast<std::uint64_t>(*seed);
  }
  section.finish();
}

}  // namespace stator::rack
