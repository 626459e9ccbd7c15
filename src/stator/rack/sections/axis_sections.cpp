#include "stator/rack/sections/axis_sections.hpp"

#include <cstdint>
#include <limits>

#include <fmt/format.h>

#include "stator/base/trigonometry.hpp"

namespace stator::rack {

namespace {

constexpr double kDegree = base::kPi / 180.0;

}  // namespace

void set_degrees(TomlSection& section, const TomlKey& key, double minimum, double maximum,
                 double& target) {
  if (const auto degrees = section.number(key, minimum, maximum)) {
    target = *degrees * kDegree;
  }
  section.note_default(key, fmt::format("{:.6g}", target / kDegree));
}

void read_load(TomlSection section, plant::MechanicalLoad& load) {
  set(section, {"inertia", "At the motor shaft", "kg m²"}, 0.0, 10.0, load.inertia);
  set(section, {"viscous_friction", "Torque that grows with speed", "N m s/rad"}, 0.0, 10.0,
      load.viscous_friction);
  set(section, {"coulomb_friction", "Torque against any motion", "N m"}, 0.0, 1000.0,
      load.coulomb_friction);
  set(section,
      {"constant_torque",
       "Positive drives the shaft forward, so a weight that is lifted forward is negative", "N m"},
      -1000.0, 1000.0, load.constant_torque);
  set(section, {"unbalance_torque", "Amplitude a of a torque −a·sin(shaft angle)", "N m"}, -1000.0,
      1000.0, load.unbalance_torque);
  set(section, {"brake_torque", "The holding brake resists with; 0: none fitted", "N m"}, 0.0,
      1000.0, load.brake_torque);
  set(section, {"end_stop_minimum", "Lower end of the travel", "revolutions"}, -kFarAway, kFarAway,
      load.end_stop_minimum);
  set(section, {"end_stop_maximum", "Upper end of the travel", "revolutions"}, -kFarAway, kFarAway,
      load.end_stop_maximum);
  set(section, {"end_stop_stiffness", "Of both end stops", "N m/rad"}, 0.1, 1e6,
      load.end_stop_stiffness);
  set(section, {"end_stop_damping", "Of both end stops", "N m s/rad"}, 0.0, 100.0,
      load.end_stop_damping);
  if (load.end_stop_minimum >= load.end_stop_maximum) {
    section.refuse("end_stop_minimum", "\"end_stop_minimum\" must lie below \"end_stop_maximum\"");
  }
  section.finish();
}

void read_brake(TomlSection section, plant::HoldingBrake& brake) {
  using namespace base::literals;
  if (const auto output = section.integer(
          {"output", "Output that feeds the coil of the brake; by default the own one of the axis"},
          0, 3)) {
    brake.output = static_cast<std::uint8_t>(*output);
  }
  set(section, {"pull_in", "Mean voltage, as a fraction of full, from which the coil pulls"}, 0.01,
      1.0, brake.pull_in_duty);
  section.boolean(
      {"closed_by_current", "true: a power-on brake, closed by its coil; else a spring closes it"},
      brake.closed_by_current);
  section.duration({"release_time", "From switching the coil to the shaft being free"}, 0_ms, 10_s,
                   brake.release_time);
  section.duration({"apply_time", "From switching the coil to the shaft being held"}, 0_ms, 10_s,
                   brake.apply_time);
  section.finish();
}

void read_supply(TomlSection section, plant::SupplyParameters& supply) {
  set(section,
      {"capacitance",
       "Of the capacitor at the power stage; 0: an ideal source, which also takes energy back",
       "F"},
      0.0, 1.0, supply.capacitance);
  set(section, {"source_resistance", "Of source and cable; through it no energy goes back", "Ω"},
      1e-3, 1e3, supply.source_resistance);
  set(section,
      {"brake_chopper_voltage",
       "From which a brake chopper burns what the motor returns; without one, braking harder than "
       "friction does raises the voltage until a servo drive switches off",
       "V"},
      1.0, 1000.0, supply.chopper_voltage);
  set(section, {"brake_chopper_resistance", "Of the resistor of the brake chopper", "Ω"}, 0.1, 1e4,
      supply.chopper_resistance);
  section.finish();
}

void read_motor_thermal(TomlSection section, plant::ThermalParameters& thermal) {
  set(section, {"winding_capacity", "Heat capacity", "J/K"}, 1e-3, 1e6, thermal.inner_capacity);
  set(section, {"housing_capacity", "Heat capacity", "J/K"}, 1e-3, 1e6, thermal.outer_capacity);
  set(section, {"winding_to_housing", "Thermal resistance", "K/W"}, 1e-3, 1e3,
      thermal.inner_to_outer);
  set(section, {"housing_to_ambient", "Thermal resistance", "K/W"}, 1e-3, 1e3,
      thermal.outer_to_ambient);
  section.finish();
}

void read_encoder(TomlSection section, plant::EncoderParameters& encoder) {
  section.integer({"counts_per_revolution", "After quadrature evaluation; 0: none fitted"}, 0,
                  1 << 24, encoder.counts_per_revolution);
  section.boolean({"reversed", "Counts down when the shaft turns forward"}, encoder.reversed);
  set(section, {"offset", "By which the disc is turned against the shaft", "counts"}, -1e9, 1e9,
      encoder.offset);
  section.integer({"index_position", "Count within the revolution at which N is active"}, 0,
                  1 << 24, encoder.index_position);
  section.boolean({"index_active_low", "N is low at its pulse and high elsewhere"},
                  encoder.index_active_low);
  section.finish();
}

void read_switch(TomlSection section, plant::PositionSwitch& position_switch) {
  position_switch.fitted = true;
  position_switch.pressed_from = -std::numeric_limits<double>::infinity();
  position_switch.pressed_to = std::numeric_limits<double>::infinity();
  set(section, {"pressed_from", "Where the switch begins to be pressed", "revolutions"}, -kFarAway,
      kFarAway, position_switch.pressed_from);
  set(section, {"pressed_to", "Where it ends", "revolutions"}, -kFarAway, kFarAway,
      position_switch.pressed_to);
  section.boolean({"normally_closed", "The signal is low while pressed"},
                  position_switch.normally_closed);
  if (position_switch.pressed_from > position_switch.pressed_to) {
    section.refuse("pressed_from", "\"pressed_from\" must not lie above \"pressed_to\"");
  }
  section.finish();
}

}  // namespace stator::rack
