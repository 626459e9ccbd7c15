#include "stator/devices/tmc8670/axis_world.hpp"

#include "stator/base/input_appender.hpp"
#include "stator/base/trigonometry.hpp"

namespace stator::devices::tmc8670 {

plant::PwmAxisParameters default_axis() {
  plant::PwmAxisParameters parameters;                   // 2000h:02 fits its motor
  parameters.encoders[0].counts_per_revolution = 65536;  // 2010h:01
  // Pull-ups hold open inputs high (L399-L401).
  parameters.left_switch.level_if_not_fitted = true;
  parameters.right_switch.level_if_not_fitted = true;
  parameters.home_switch.level_if_not_fitted = true;
  return parameters;
}

double AxisWorld::shaft_speed() const {
  return stage_.plant().speed() / base::kTwoPi;
}

void AxisWorld::append_signals(std::vector<product::Signal>& signals) const {
  const auto add = [&](const char* name, const char* unit, base::SignalReader read) {
    signals.push_back({std::string("axis0.") + name, unit, read});
  };
  using Read = base::SignalReader;
  add("shaft_position", "rev", Read::bind<&AxisWorld::shaft_position>(*this));
  add("shaft_speed", "rev/s", Read::bind<&AxisWorld::shaft_speed>(*this));
  add("torque", "Nm", Read::bind<&AxisWorld::torque>(*this));
  add("load_torque", "Nm", Read::bind<&AxisWorld::load_torque>(*this));
  add("direct_current", "A", Read::bind<&AxisWorld::direct_current>(*this));
  add("quadrature_current", "A", Read::bind<&AxisWorld::quadrature_current>(*this));
  add("current_u", "A", Read::bind<&AxisWorld::current<0>>(*this));
  add("current_v", "A", Read::bind<&AxisWorld::current<1>>(*this));
  add("current_w", "A", Read::bind<&AxisWorld::current<2>>(*this));
  add("current_y2", "A", Read::bind<&AxisWorld::current<3>>(*this));
  add("encoder", "count", Read::bind<&AxisWorld::encoder<0>>(*this));
  add("encoder_2", "count", Read::bind<&AxisWorld::encoder<1>>(*this));
  add("halls", "", Read::bind<&AxisWorld::halls>(*this));
  add("supply_voltage", "V", Read::bind<&AxisWorld::supply_voltage>(*this));
  add("supply_power", "W", Read::bind<&AxisWorld::supply_power>(*this));
  add("winding_temperature", "degC", Read::bind<&AxisWorld::winding_temperature>(*this));
  add("driver_temperature", "degC", Read::bind<&AxisWorld::driver_temperature>(*this));
  add("junction_temperature", "degC", Read::bind<&AxisWorld::junction_temperature>(*this));
  append_stage_signals(signals);
}

// The outputs of the chip, as an oscilloscope at its pins sees them.
void AxisWorld::append_stage_signals(std::vector<product::Signal>& signals) const {
  const auto add = [&](const char* name, base::SignalReader read) {
    signals.push_back({std::string("axis0.") + name, "", read});
  };
  using Read = base::SignalReader;
  add("duty_u", Read::bind<&AxisWorld::duty<0>>(*this));
  add("duty_v", Read::bind<&AxisWorld::duty<1>>(*this));
  add("duty_w", Read::bind<&AxisWorld::duty<2>>(*this));
  add("duty_y2", Read::bind<&AxisWorld::duty<3>>(*this));
  add("enable_out", Read::bind<&AxisWorld::enable_out>(*this));
  add("brake_chopper", Read::bind<&AxisWorld::brake_chopper>(*this));
  add("status_out", Read::bind<&AxisWorld::status_out>(*this));
}

void AxisWorld::append_inputs(std::vector<product::Input>& inputs) {
  const plant::PwmAxisParameters& world = stage_.plant().parameters();
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
  add("home_switch", "", 0.0, 1.0, Set::bind<&AxisWorld::press_home_switch>(*this),
      product::InputGroup::switches);
  add("touch_probe_1", "", 0.0, 1.0, Set::bind<&AxisWorld::set_probe<0>>(*this),
      product::InputGroup::switches);
  add("touch_probe_2", "", 0.0, 1.0, Set::bind<&AxisWorld::set_probe<1>>(*this),
      product::InputGroup::switches);
  add("ambient_temperature", "degC", -50.0, 200.0,
      Set::bind<&AxisWorld::set_ambient_temperature>(*this), product::InputGroup::heat,
      world.ambient_temperature);
  add("air_speed", "m/s", 0.0, 10.0, Set::bind<&AxisWorld::set_air_speed>(*this),
      product::InputGroup::heat);
  append_fault_inputs(inputs);
}

void AxisWorld::append_fault_inputs(std::vector<product::Input>& inputs) {
  const base::InputAppender add(inputs, "axis0.");
  using Set = base::Delegate<void(double)>;
  add("open_u", "", 0.0, 1.0, Set::bind<&AxisWorld::set_open<0>>(*this),
      product::InputGroup::driver);
  add("open_v", "", 0.0, 1.0, Set::bind<&AxisWorld::set_open<1>>(*this),
      product::InputGroup::driver);
  add("open_w", "", 0.0, 1.0, Set::bind<&AxisWorld::set_open<2>>(*this),
      product::InputGroup::driver);
  add("short_u", "", 0.0, 1.0, Set::bind<&AxisWorld::set_short<0>>(*this),
      product::InputGroup::driver);
  add("short_v", "", 0.0, 1.0, Set::bind<&AxisWorld::set_short<1>>(*this),
      product::InputGroup::driver);
  add("short_w", "", 0.0, 1.0, Set::bind<&AxisWorld::set_short<2>>(*this),
      product::InputGroup::driver);
  add("short_high_side", "", 0.0, 1.0, Set::bind<&AxisWorld::set_high_side>(*this),
      product::InputGroup::driver);
  // 0: intact, 1: stuck low, 2: stuck high
  add("hall_fault_1", "", 0.0, 2.0, Set::bind<&AxisWorld::set_hall_fault<0>>(*this),
      product::InputGroup::sensors);
  add("hall_fault_2", "", 0.0, 2.0, Set::bind<&AxisWorld::set_hall_fault<1>>(*this),
      product::InputGroup::sensors);
  add("hall_fault_3", "", 0.0, 2.0, Set::bind<&AxisWorld::set_hall_fault<2>>(*this),
      product::InputGroup::sensors);
  add("halls_swapped", "", 0.0, 1.0, Set::bind<&AxisWorld::set_halls_swapped>(*this),
      product::InputGroup::sensors);
  add("encoder_counts_lost", "count", -1e6, 1e6, Set::bind<&AxisWorld::lose_counts<0>>(*this),
      product::InputGroup::sensors);
  add("encoder_2_counts_lost", "count", -1e6, 1e6, Set::bind<&AxisWorld::lose_counts<1>>(*this),
      product::InputGroup::sensors);
  add("converter_noise", "count", 0.0, 65535.0, Set::bind<&AxisWorld::set_converter_noise>(*this),
      product::InputGroup::sensors);
  fault_inputs_.append(inputs, "axis0.");
}

}  // namespace stator::devices::tmc8670
