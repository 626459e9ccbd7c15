#include "stator/devices/tmcc160/axis_world.hpp"

#include "stator/base/input_appender.hpp"
#include "stator/base/trigonometry.hpp"

namespace stator::devices::tmcc160 {

plant::ServoAxisParameters default_axis() {
  plant::ServoAxisParameters parameters;
  parameters.motor.pole_pairs = 4;                  // 2010h:01
  parameters.encoder.counts_per_revolution = 4000;  // 2080h:02
  return parameters;
}

double AxisWorld::shaft_speed() const {
  return plant_.observe().speed / base::kTwoPi;
}

// The electronics of the module empty the capacitor of its power stage within milliseconds; the
// plant's supply knows of the motor alone.
void AxisWorld::set_supply_voltage(double voltage) {
  plant_.set_supply_voltage(voltage);
  if (plant_.state().supply.voltage > voltage) {
    plant::ServoAxisState state = plant_.state();
    state.supply.voltage = voltage;
    plant_.restore(state);
  }
}

void AxisWorld::append_signals(std::vector<product::Signal>& signals) const {
  const auto add = [&](const char* name, const char* unit, base::SignalReader read) {
    signals.push_back({std::string("axis0.") + name, unit, read});
  };
  using Read = base::SignalReader;
  add("shaft_position", "rev", Read::bind<&AxisWorld::shaft_position>(*this));
  add("shaft_speed", "rev/s", Read::bind<&AxisWorld::shaft_speed>(*this));
  add("phase_current_u", "A", Read::bind<&AxisWorld::phase_current_u>(*this));
  add("phase_current_v", "A", Read::bind<&AxisWorld::phase_current_v>(*this));
  add("phase_current_w", "A", Read::bind<&AxisWorld::phase_current_w>(*this));
  add("direct_current", "A", Read::bind<&AxisWorld::direct_current>(*this));
  add("quadrature_current", "A", Read::bind<&AxisWorld::quadrature_current>(*this));
  add("torque", "Nm", Read::bind<&AxisWorld::torque>(*this));
  add("load_torque", "Nm", Read::bind<&AxisWorld::load_torque>(*this));
  add("encoder", "count", Read::bind<&AxisWorld::encoder>(*this));
  add("halls", "", Read::bind<&AxisWorld::halls>(*this));
  add("supply_voltage", "V", Read::bind<&AxisWorld::supply_voltage>(*this));
  add("supply_power", "W", Read::bind<&AxisWorld::supply_power>(*this));
  add("winding_temperature", "degC", Read::bind<&AxisWorld::winding_temperature>(*this));
  add("driver_temperature", "degC", Read::bind<&AxisWorld::driver_temperature>(*this));
}

void AxisWorld::append_inputs(std::vector<product::Input>& inputs) {
  const plant::ServoAxisParameters& world = plant_.parameters();
  const base::InputAppender add(inputs, "axis0.");
  using Set = base::Delegate<void(double)>;
  add("load_torque", "Nm", -1000.0, 1000.0, Set::bind<&AxisWorld::set_load_torque>(*this),
      product::InputGroup::load);
  add("supply_voltage", "V", 0.0, 100.0, Set::bind<&AxisWorld::set_supply_voltage>(*this),
      product::InputGroup::supply, world.supply_voltage);
  add("left_switch", "", 0.0, 1.0, Set::bind<&AxisWorld::press_left_switch>(*this),
      product::InputGroup::switches);
  add("right_switch", "", 0.0, 1.0, Set::bind<&AxisWorld::press_right_switch>(*this),
      product::InputGroup::switches);
  add("ambient_temperature", "degC", -50.0, 200.0,
      Set::bind<&AxisWorld::set_ambient_temperature>(*this), product::InputGroup::heat,
      world.ambient_temperature);
  add("open_u", "", 0.0, 1.0, Set::bind<&AxisWorld::set_phase_fault<&Faults::open, 0>>(*this),
      product::InputGroup::driver);
  add("open_v", "", 0.0, 1.0, Set::bind<&AxisWorld::set_phase_fault<&Faults::open, 1>>(*this),
      product::InputGroup::driver);
  add("open_w", "", 0.0, 1.0, Set::bind<&AxisWorld::set_phase_fault<&Faults::open, 2>>(*this),
      product::InputGroup::driver);
  add("short_u", "", 0.0, 1.0, Set::bind<&AxisWorld::set_phase_fault<&Faults::shorted, 0>>(*this),
      product::InputGroup::driver);
  add("short_v", "", 0.0, 1.0, Set::bind<&AxisWorld::set_phase_fault<&Faults::shorted, 1>>(*this),
      product::InputGroup::driver);
  add("short_w", "", 0.0, 1.0, Set::bind<&AxisWorld::set_phase_fault<&Faults::shorted, 2>>(*this),
      product::InputGroup::driver);
  add("short_high_side", "", 0.0, 1.0, Set::bind<&AxisWorld::set_fault<&Faults::high_side>>(*this),
      product::InputGroup::driver);
  // 0: intact, 1: stuck low, 2: stuck high
  add("hall_fault_1", "", 0.0, 2.0, Set::bind<&AxisWorld::set_hall_fault<0>>(*this),
      product::InputGroup::sensors);
  add("hall_fault_2", "", 0.0, 2.0, Set::bind<&AxisWorld::set_hall_fault<1>>(*this),
      product::InputGroup::sensors);
  add("hall_fault_3", "", 0.0, 2.0, Set::bind<&AxisWorld::set_hall_fault<2>>(*this),
      product::InputGroup::sensors);
  add("halls_swapped", "", 0.0, 1.0,
      Set::bind<&AxisWorld::set_fault<&Faults::halls_swapped>>(*this),
      product::InputGroup::sensors);
  add("encoder_counts_lost", "count", -1e6, 1e6, Set::bind<&AxisWorld::lose_counts>(*this),
      product::InputGroup::sensors);
  add("current_noise", "A", 0.0, 100.0, Set::bind<&AxisWorld::set_current_noise>(*this),
      product::InputGroup::sensors);
  fault_inputs_.append(inputs, "axis0.");
}

}  // namespace stator::devices::tmcc160
