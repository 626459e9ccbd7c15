#include "rack/axis_sections.hpp"

#include <cstdint>
#include <limits>

#include <fmt/format.h>

#include "rack/text.hpp"

namespace stator::rack {

void refuse_motor(TomlSection& section, const std::string& motor,
                  const std::set<std::string>& names) {
  const std::string guess = closest_match(motor, names);
  section.refuse("motor",
                 fmt::format("motor \"{}\" is not known{}; the motors are: {}", motor,
                             guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess),
                             fmt::join(names, ", ")));
}

void read_load(TomlSection section, plant::MechanicalLoad& load) {
  set(section, "inertia", 0.0, 10.0, load.inertia);
  set(section, "viscous_friction", 0.0, 10.0, load.viscous_friction);
  set(section, "coulomb_friction", 0.0, 1000.0, load.coulomb_friction);
  set(section, "constant_torque", -1000.0, 1000.0, load.constant_torque);
  set(section, "unbalance_torque", -1000.0, 1000.0, load.unbalance_torque);
  set(section, "brake_torque", 0.0, 1000.0, load.brake_torque);
  set(section, "end_stop_minimum", -kFarAway, kFarAway, load.end_stop_minimum);
  set(section, "end_stop_maximum", -kFarAway, kFarAway, load.end_stop_maximum);
  set(section, "end_stop_stiffness", 0.1, 1e6, load.end_stop_stiffness);
  set(section, "end_stop_damping", 0.0, 100.0, load.end_stop_damping);
  if (load.end_stop_minimum >= load.end_stop_maximum) {
    section.refuse("end_stop_minimum", "\"end_stop_minimum\" must lie below \"end_stop_maximum\"");
  }
  section.finish();
}

void read_brake(TomlSection section, plant::HoldingBrake& brake) {
  using namespace base::literals;
  if (const auto output = section.integer("output", 0, 3)) {
    brake.output = static_cast<std::uint8_t>(*output);
  }
  set(section, "pull_in", 0.01, 1.0, brake.pull_in_duty);
  brake.closed_by_current = section.boolean("closed_by_current").value_or(brake.closed_by_current);
  brake.release_time = section.duration("release_time", 0_ms, 10_s).value_or(brake.release_time);
  brake.apply_time = section.duration("apply_time", 0_ms, 10_s).value_or(brake.apply_time);
  section.finish();
}

void read_supply(TomlSection section, plant::SupplyParameters& supply) {
  set(section, "capacitance", 0.0, 1.0, supply.capacitance);
  set(section, "source_resistance", 1e-3, 1e3, supply.source_resistance);
  set(section, "brake_chopper_voltage", 1.0, 1000.0, supply.chopper_voltage);
  set(section, "brake_chopper_resistance", 0.1, 1e4, supply.chopper_resistance);
  section.finish();
}

void read_motor_thermal(TomlSection section, plant::ThermalParameters& thermal) {
  set(section, "winding_capacity", 1e-3, 1e6, thermal.inner_capacity);
  set(section, "housing_capacity", 1e-3, 1e6, thermal.outer_capacity);
  set(section, "winding_to_housing", 1e-3, 1e3, thermal.inner_to_outer);
  set(section, "housing_to_ambient", 1e-3, 1e3, thermal.outer_to_ambient);
  section.finish();
}

void read_encoder(TomlSection section, plant::EncoderParameters& encoder) {
  encoder.counts_per_revolution =
      section.integer("counts_per_revolution", 0, 1 << 24).value_or(encoder.counts_per_revolution);
  encoder.reversed = section.boolean("reversed").value_or(encoder.reversed);
  set(section, "offset", -1e9, 1e9, encoder.offset);
  encoder.index_position =
      section.integer("index_position", 0, 1 << 24).value_or(encoder.index_position);
  encoder.index_active_low = section.boolean("index_active_low").value_or(encoder.index_active_low);
  section.finish();
}

void read_switch(TomlSection section, plant::PositionSwitch& position_switch) {
  position_switch.fitted = true;
  position_switch.pressed_from = -std::numeric_limits<double>::infinity();
  position_switch.pressed_to = std::numeric_limits<double>::infinity();
  set(section, "pressed_from", -kFarAway, kFarAway, position_switch.pressed_from);
  set(section, "pressed_to", -kFarAway, kFarAway, position_switch.pressed_to);
  position_switch.normally_closed =
      section.boolean("normally_closed").value_or(position_switch.normally_closed);
  if (position_switch.pressed_from > position_switch.pressed_to) {
    section.refuse("pressed_from", "\"pressed_from\" must not lie above \"pressed_to\"");
  }
  section.finish();
}

}  // namespace stator::rack
