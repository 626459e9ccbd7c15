#include "stator/plant/axes/axis_fault_inputs.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace stator::plant {

namespace {

using base::InputGroup;
using enum AxisPart;

template <typename Kind>
Kind kind_of(double value) {
  return static_cast<Kind>(std::lround(value));
}

bool is_set(double value) {
  return value >= 0.5;
}

template <std::size_t Switch>
void stick(AxisFaults& faults, double value) {
  faults.switches[Switch] = kind_of<SwitchFault>(value);
}

// A captureless lambda for every row: what it sets can be read beside its name.
constexpr std::array kInputs{
    // 1: it stands where it is, 2: it turns between jam_from and jam_to only
    AxisFaultInput{"jammed", "", 0.0, 2.0, InputGroup::load, shaft,
                   [](AxisFaults& f, double v) { f.shaft.jam = kind_of<Jam>(v); }},
    AxisFaultInput{"jam_from", "rev", -1e6, 1e6, InputGroup::load, shaft,
                   [](AxisFaults& f, double v) { f.shaft.jam_from = v; }},
    AxisFaultInput{"jam_to", "rev", -1e6, 1e6, InputGroup::load, shaft,
                   [](AxisFaults& f, double v) { f.shaft.jam_to = v; }},
    AxisFaultInput{"jamming_torque", "Nm", 0.0, 1000.0, InputGroup::load, shaft,
                   [](AxisFaults& f, double v) { f.shaft.jamming_torque = v; }},
    AxisFaultInput{"added_viscous_friction", "Nm s/rad", 0.0, 10.0, InputGroup::load, shaft,
                   [](AxisFaults& f, double v) { f.shaft.viscous_friction = v; }},
    AxisFaultInput{"added_inertia", "kg m^2", -10.0, 10.0, InputGroup::load, shaft,
                   [](AxisFaults& f, double v) { f.shaft.inertia = v; }},
    // 1: it does not release, 2: it does not hold
    AxisFaultInput{"brake_fault", "", 0.0, 2.0, InputGroup::load, brake,
                   [](AxisFaults& f, double v) { f.shaft.brake = kind_of<BrakeFault>(v); }},
    AxisFaultInput{"brake_drag", "Nm", 0.0, 1000.0, InputGroup::load, brake,
                   [](AxisFaults& f, double v) { f.shaft.brake_drag = v; }},
    AxisFaultInput{"supply_offset", "V", -100.0, 100.0, InputGroup::supply, shaft,
                   [](AxisFaults& f, double v) { f.supply.offset = v; }},
    AxisFaultInput{"supply_resistance", "ohm", 0.0, 100.0, InputGroup::supply, shaft,
                   [](AxisFaults& f, double v) { f.supply.resistance = v; }},
    AxisFaultInput{"driver_heat", "W", 0.0, 10'000.0, InputGroup::heat, shaft,
                   [](AxisFaults& f, double v) { f.heat.driver_heat = v; }},
    AxisFaultInput{"motor_heat", "W", 0.0, 10'000.0, InputGroup::heat, shaft,
                   [](AxisFaults& f, double v) { f.heat.motor_heat = v; }},
    AxisFaultInput{"driver_temperature_offset", "K", -300.0, 300.0, InputGroup::heat,
                   driver_thermometer, [](AxisFaults& f, double v) { f.heat.driver_reading = v; }},
    // 1: it is never pressed, 2: it always is
    AxisFaultInput{"left_switch_fault", "", 0.0, 2.0, InputGroup::switches, limit_switches,
                   stick<0>},
    AxisFaultInput{"right_switch_fault", "", 0.0, 2.0, InputGroup::switches, limit_switches,
                   stick<1>},
    AxisFaultInput{"home_switch_fault", "", 0.0, 2.0, InputGroup::switches, home_switch, stick<2>},
    AxisFaultInput{"encoder_lost", "", 0.0, 1.0, InputGroup::sensors, encoder,
                   [](AxisFaults& f, double v) { f.encoders[0].lost = is_set(v); }},
    AxisFaultInput{"encoder_index_lost", "", 0.0, 1.0, InputGroup::sensors, encoder,
                   [](AxisFaults& f, double v) { f.encoders[0].index_lost = is_set(v); }},
    // 1: A, 2: B
    AxisFaultInput{
        "encoder_dead_channel", "", 0.0, 2.0, InputGroup::sensors, encoder,
        [](AxisFaults& f, double v) { f.encoders[0].dead_channel = kind_of<std::uint8_t>(v); }},
    AxisFaultInput{"encoder_slip", "rev/rev", -1.0, 1.0, InputGroup::sensors, encoder,
                   [](AxisFaults& f, double v) { f.encoders[0].slip = v; }},
    AxisFaultInput{"encoder_slip_torque", "Nm", 0.0, 1000.0, InputGroup::sensors, encoder,
                   [](AxisFaults& f, double v) { f.encoders[0].slip_torque = v; }},
    AxisFaultInput{"encoder_noise", "count", 0.0, 1e6, InputGroup::sensors, encoder,
                   [](AxisFaults& f, double v) { f.encoders[0].noise = v; }},
    AxisFaultInput{"encoder_2_lost", "", 0.0, 1.0, InputGroup::sensors, second_encoder,
                   [](AxisFaults& f, double v) { f.encoders[1].lost = is_set(v); }},
    AxisFaultInput{"encoder_2_index_lost", "", 0.0, 1.0, InputGroup::sensors, second_encoder,
                   [](AxisFaults& f, double v) { f.encoders[1].index_lost = is_set(v); }},
    AxisFaultInput{"encoder_2_slip", "rev/rev", -1.0, 1.0, InputGroup::sensors, second_encoder,
                   [](AxisFaults& f, double v) { f.encoders[1].slip = v; }},
    AxisFaultInput{"encoder_2_noise", "count", 0.0, 1e6, InputGroup::sensors, second_encoder,
                   [](AxisFaults& f, double v) { f.encoders[1].noise = v; }},
};

}  // namespace

std::span<const AxisFaultInput> axis_fault_inputs() {
  return kInputs;
}

}  // namespace stator::plant
