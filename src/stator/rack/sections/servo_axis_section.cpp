#include "stator/rack/sections/servo_axis_section.hpp"

#include <array>
#include <optional>
#include <set>
#include <string>

#include <fmt/format.h>

#include "stator/rack/sections/axis_sections.hpp"

namespace stator::rack {

namespace {

/// A limit that is not exact in binary is still in range itself.
constexpr double kRounding = 1e-9;

std::set<std::string> motor_names() {
  std::set<std::string> names;
  for (const plant::ThreePhaseMotorSheet& sheet : plant::three_phase_motor_sheets()) {
    names.emplace(sheet.name);
  }
  return names;
}

void read_current_sensing(TomlSection section, plant::CurrentSensingParameters& sensing) {
  constexpr std::array kPhases{"u", "v", "w"};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string phase(kPhases[k]);
    set(section, {"gain_" + phase, "1 measures rightly"}, 0.0, 2.0, sensing.gain[k]);
    set(section, {"offset_" + phase, "What is measured without current", "A"}, -100.0, 100.0,
        sensing.offset[k]);
  }
  set(section, {"noise", "Standard deviation of a measured current", "A"}, 0.0, 100.0,
      sensing.noise);
  set(section, {"resolution", "Per step of the converter; 0: not quantised", "A"}, 0.0, 100.0,
      sensing.resolution);
  set(section, {"range", "At which the converter saturates", "A"}, 1e-3, 1e6, sensing.range);
  section.finish();
}

void read_inverter(TomlSection section, plant::InverterParameters& inverter) {
  set(section, {"pwm_frequency", "Of the power stage", "Hz"}, 1e3, 1e6, inverter.pwm_frequency);
  read_half_bridges(section, 1.0 / inverter.pwm_frequency, inverter);
}

}  // namespace

void read_three_phase_motor(TomlSection section, plant::ThreePhaseMotorParameters& motor) {
  section.integer({"pole_pairs", "Of the motor"}, 1, 100, motor.pole_pairs);
  set(section, {"resistance", "Of a phase, line to star point", "Ω"}, 1e-3, 1e3, motor.resistance);
  set(section, {"direct_inductance", "Of a phase", "H"}, 1e-6, 1.0, motor.direct_inductance);
  set(section, {"quadrature_inductance", "Of a phase", "H"}, 1e-6, 1.0,
      motor.quadrature_inductance);
  set(section,
      {"flux_linkage",
       "Peak, per electrical radian; the torque constant is 3/2 pole pairs × this, per A peak",
       "V s"},
      1e-5, 10.0, motor.flux_linkage);
  set(section, {"trapezoidal_share", "Of the EMF; 0: sinusoidal, 1: trapezoidal, between: a blend"},
      0.0, 1.0, motor.back_emf.trapezoidal_share);
  set_degrees(section, {"flat_top", "Over which the trapezoid is flat", "electrical degrees"}, 0.0,
              170.0, motor.back_emf.flat_top);
  set(section, {"cogging_torque", "Amplitude", "N m"}, 0.0, 100.0, motor.cogging[0].amplitude);
  section.integer({"cogging_order", "Periods per electrical period"}, 1, 24,
                  motor.cogging[0].order);
  set(section, {"rotor_inertia", "Of the rotor alone", "kg m²"}, 1e-9, 10.0, motor.rotor_inertia);
  set(section, {"viscous_friction", "Torque that grows with speed", "N m s/rad"}, 0.0, 10.0,
      motor.viscous_friction);
  set(section, {"coulomb_friction", "Torque against any motion", "N m"}, 0.0, 100.0,
      motor.coulomb_friction);
  set(section, {"static_friction", "Torque that holds the shaft at standstill", "N m"}, 0.0, 100.0,
      motor.static_friction);
  set(section, {"rated_current", "Peak", "A"}, 1e-3, 1e3, motor.rated_current);
  if (motor.static_friction < motor.coulomb_friction) {
    section.refuse("static_friction", "\"static_friction\" must not be below \"coulomb_friction\"");
  }
  section.finish();
}

void read_half_bridges(TomlSection& section, double pwm_period,
                       plant::InverterParameters& inverter) {
  set(section, {"on_resistance", "Of a transistor", "Ω"}, 0.0, 10.0, inverter.on_resistance);
  set(section,
      {"dead_time", "That the stage does not compensate, at most a tenth of the PWM period", "s"},
      0.0, 1e-5, inverter.dead_time);
  set(section, {"diode_drop", "Of a body diode", "V"}, 0.0, 5.0, inverter.diode_drop);
  set(section, {"chip_capacity", "Heat capacity", "J/K"}, 1e-3, 1e6,
      inverter.thermal.inner_capacity);
  set(section, {"board_capacity", "Heat capacity", "J/K"}, 1e-3, 1e6,
      inverter.thermal.outer_capacity);
  set(section, {"chip_to_board", "Thermal resistance", "K/W"}, 1e-3, 1e3,
      inverter.thermal.inner_to_outer);
  set(section, {"board_to_ambient", "Thermal resistance", "K/W"}, 1e-3, 1e3,
      inverter.thermal.outer_to_ambient);
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
  section.boolean({"fitted", "false: the inputs read low"}, halls.fitted);
  section.boolean({"inverted", "Open-collector sensors that read the other way round"},
                  halls.inverted);
  set_degrees(section, {"offset", "By which the sensors are turned forward", "electrical degrees"},
              -360.0, 360.0, halls.offset);
  set_degrees(section, {"h1_error", "By which it sits ahead of its place", "electrical degrees"},
              -25.0, 25.0, halls.placement_error[0]);
  set_degrees(section, {"h2_error", "By which it sits ahead of its place", "electrical degrees"},
              -25.0, 25.0, halls.placement_error[1]);
  set_degrees(section, {"h3_error", "By which it sits ahead of its place", "electrical degrees"},
              -25.0, 25.0, halls.placement_error[2]);
  set_degrees(section,
              {"hysteresis", "From the middle to either switching point", "electrical degrees"},
              0.0, 25.0, halls.hysteresis);
  section.finish();
}

void read_servo_axis(TomlSection& section, plant::ServoAxisParameters& parameters) {
  if (const auto name = section.choice({"motor", "Motor by name"}, motor_names())) {
    parameters.motor = *plant::find_three_phase_motor(*name);
  }
  if (auto motor = section.section({"motor_data", "Changes single values of the motor"})) {
    read_three_phase_motor(*motor, parameters.motor);
  }
  if (auto thermal = section.section({"motor_thermal", "Of the motor"})) {
    read_motor_thermal(*thermal, parameters.motor.thermal);
  }
  read_axis_surroundings(section, parameters);
  if (auto inverter = section.section({"inverter", "The power stage"})) {
    read_inverter(*inverter, parameters.inverter);
  }
  if (auto halls = section.section({"halls", "The Hall sensors"})) {
    read_halls(*halls, parameters.halls);
  }
  if (auto sensing = section.section({"current_sensing", "How phase currents are measured"})) {
    read_current_sensing(*sensing, parameters.current_sensing);
  }
  section.finish();
}

}  // namespace stator::rack
