#include "rack/servo_axis_section.hpp"

#include <array>
#include <optional>
#include <set>
#include <string>

#include <fmt/format.h>

#include "base/trigonometry.hpp"
#include "rack/axis_sections.hpp"

namespace stator::rack {

namespace {

constexpr double kDegree = base::kPi / 180.0;
/// A limit that is not exact in binary is still in range itself.
constexpr double kRounding = 1e-9;

std::optional<plant::ThreePhaseMotorParameters> motor_named(TomlSection& section,
                                                            const std::string& name) {
  if (const auto motor = plant::find_three_phase_motor(name)) {
    return motor;
  }
  std::set<std::string> names;
  for (const plant::ThreePhaseMotorSheet& sheet : plant::three_phase_motor_sheets()) {
    names.emplace(sheet.name);
  }
  refuse_motor(section, name, names);
  return std::nullopt;
}

void set_degrees(TomlSection& section, const char* key, double limit, double& target) {
  if (const auto degrees = section.number(key, -limit, limit)) {
    target = *degrees * kDegree;
  }
}

void read_current_sensing(TomlSection section, plant::CurrentSensingParameters& sensing) {
  constexpr std::array kPhases{"u", "v", "w"};
  for (std::size_t k = 0; k < 3; ++k) {
    set(section, (std::string("gain_") + kPhases[k]).c_str(), 0.0, 2.0, sensing.gain[k]);
    set(section, (std::string("offset_") + kPhases[k]).c_str(), -100.0, 100.0, sensing.offset[k]);
  }
  set(section, "noise", 0.0, 100.0, sensing.noise);
  set(section, "resolution", 0.0, 100.0, sensing.resolution);
  set(section, "range", 1e-3, 1e6, sensing.range);
  section.finish();
}

void read_inverter(TomlSection section, plant::InverterParameters& inverter) {
  set(section, "pwm_frequency", 1e3, 1e6, inverter.pwm_frequency);
  read_half_bridges(section, 1.0 / inverter.pwm_frequency, inverter);
}

}  // namespace

void read_three_phase_motor(TomlSection section, plant::ThreePhaseMotorParameters& motor) {
  motor.pole_pairs =
      static_cast<int>(section.integer("pole_pairs", 1, 100).value_or(motor.pole_pairs));
  set(section, "resistance", 1e-3, 1e3, motor.resistance);
  set(section, "direct_inductance", 1e-6, 1.0, motor.direct_inductance);
  set(section, "quadrature_inductance", 1e-6, 1.0, motor.quadrature_inductance);
  set(section, "flux_linkage", 1e-5, 10.0, motor.flux_linkage);
  set(section, "trapezoidal_share", 0.0, 1.0, motor.back_emf.trapezoidal_share);
  if (const auto degrees = section.number("flat_top", 0.0, 170.0)) {
    motor.back_emf.flat_top = *degrees * kDegree;
  }
  set(section, "cogging_torque", 0.0, 100.0, motor.cogging[0].amplitude);
  motor.cogging[0].order =
      static_cast<int>(section.integer("cogging_order", 1, 24).value_or(motor.cogging[0].order));
  set(section, "rotor_inertia", 1e-9, 10.0, motor.rotor_inertia);
  set(section, "viscous_friction", 0.0, 10.0, motor.viscous_friction);
  set(section, "coulomb_friction", 0.0, 100.0, motor.coulomb_friction);
  set(section, "static_friction", 0.0, 100.0, motor.static_friction);
  set(section, "rated_current", 1e-3, 1e3, motor.rated_current);
  if (motor.static_friction < motor.coulomb_friction) {
    section.refuse("static_friction", "\"static_friction\" must not be below \"coulomb_friction\"");
  }
  section.finish();
}

void read_half_bridges(TomlSection& section, double pwm_period,
                       plant::InverterParameters& inverter) {
  set(section, "on_resistance", 0.0, 10.0, inverter.on_resistance);
  set(section, "dead_time", 0.0, 1e-5, inverter.dead_time);
  set(section, "diode_drop", 0.0, 5.0, inverter.diode_drop);
  set(section, "chip_capacity", 1e-3, 1e6, inverter.thermal.inner_capacity);
  set(section, "board_capacity", 1e-3, 1e6, inverter.thermal.outer_capacity);
  set(section, "chip_to_board", 1e-3, 1e3, inverter.thermal.inner_to_outer);
  set(section, "board_to_ambient", 1e-3, 1e3, inverter.thermal.outer_to_ambient);
  const double longest = 0.1 * pwm_period;
  if (inverter.dead_time > longest * (1.0 + kRounding)) {
    section.refuse("dead_time",
                   fmt::format("\"dead_time\" must not exceed a tenth of the PWM period, "
                               "{:.3g} s here",
                               longest));
  }
  section.finish();
}

void read_halls(TomlSection section, plant::HallSensorParameters& halls) {
  halls.fitted = section.boolean("fitted").value_or(halls.fitted);
  halls.inverted = section.boolean("inverted").value_or(halls.inverted);
  set_degrees(section, "offset", 360.0, halls.offset);
  set_degrees(section, "h1_error", 25.0, halls.placement_error[0]);
  set_degrees(section, "h2_error", 25.0, halls.placement_error[1]);
  set_degrees(section, "h3_error", 25.0, halls.placement_error[2]);
  if (const auto degrees = section.number("hysteresis", 0.0, 25.0)) {
    halls.hysteresis = *degrees * kDegree;
  }
  section.finish();
}

void read_servo_axis(TomlSection& section, plant::ServoAxisParameters& parameters) {
  if (const auto name = section.text("motor")) {
    parameters.motor = motor_named(section, *name).value_or(parameters.motor);
  }
  if (auto motor = section.section("motor_data")) {
    read_three_phase_motor(*motor, parameters.motor);
  }
  if (auto thermal = section.section("motor_thermal")) {
    read_motor_thermal(*thermal, parameters.motor.thermal);
  }
  read_axis_surroundings(section, parameters);
  if (auto inverter = section.section("inverter")) {
    read_inverter(*inverter, parameters.inverter);
  }
  if (auto halls = section.section("halls")) {
    read_halls(*halls, parameters.halls);
  }
  if (auto sensing = section.section("current_sensing")) {
    read_current_sensing(*sensing, parameters.current_sensing);
  }
  section.finish();
}

}  // namespace stator::rack
