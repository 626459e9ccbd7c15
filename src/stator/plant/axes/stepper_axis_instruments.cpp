#include "stator/plant/axes/stepper_axis_instruments.hpp"

#include "stator/base/input_appender.hpp"

namespace stator::plant {

void StepperAxisInstruments::append_signals(std::vector<base::Signal>& signals,
                                            const std::string& prefix) const {
  const auto add = [&](const char* name, const char* unit, base::SignalReader read) {
    signals.push_back({prefix + name, unit, read});
  };
  using Self = StepperAxisInstruments;
  using Read = base::SignalReader;
  add("shaft_position", "rev", Read::bind<&Self::shaft_position>(*this));
  add("shaft_speed", "rev/s", Read::bind<&Self::shaft_speed>(*this));
  add("coil_current_a", "A", Read::bind<&Self::coil_current<0>>(*this));
  add("coil_current_b", "A", Read::bind<&Self::coil_current<1>>(*this));
  add("torque", "Nm", Read::bind<&Self::torque>(*this));
  add("load_torque", "Nm", Read::bind<&Self::load_torque>(*this));
  add("load_angle", "rad", Read::bind<&Self::load_angle>(*this));
  add("supply_voltage", "V", Read::bind<&Self::supply_voltage>(*this));
  add("winding_temperature", "degC", Read::bind<&Self::winding_temperature>(*this));
  add("driver_temperature", "degC", Read::bind<&Self::driver_temperature>(*this));
}

void StepperAxisInstruments::append_inputs(std::vector<base::Input>& inputs,
                                           const std::string& prefix) {
  const StepperAxisParameters& world = axis_.parameters();
  const base::InputAppender add(inputs, prefix);
  using Self = StepperAxisInstruments;
  using Set = base::Delegate<void(double)>;
  add("load_torque", "Nm", -1000.0, 1000.0, Set::bind<&Self::set_load_torque>(*this),
      base::InputGroup::load);
  add("supply_voltage", "V", 0.0, 100.0, Set::bind<&Self::set_supply_voltage>(*this),
      base::InputGroup::supply, world.supply_voltage);
  if (has(AxisPart::limit_switches)) {
    add("left_switch", "", 0.0, 1.0, Set::bind<&Self::press_left_switch>(*this),
        base::InputGroup::switches);
    add("right_switch", "", 0.0, 1.0, Set::bind<&Self::press_right_switch>(*this),
        base::InputGroup::switches);
  }
  if (has(AxisPart::home_switch)) {
    add("home_switch", "", 0.0, 1.0, Set::bind<&Self::press_home_switch>(*this),
        base::InputGroup::switches);
  }
  add("ambient_temperature", "degC", -50.0, 200.0, Set::bind<&Self::set_ambient_temperature>(*this),
      base::InputGroup::heat, world.ambient_temperature);
  add("open_a", "", 0.0, 1.0, Set::bind<&Self::set_phase_fault<&Faults::open, 0>>(*this),
      base::InputGroup::driver);
  add("open_b", "", 0.0, 1.0, Set::bind<&Self::set_phase_fault<&Faults::open, 1>>(*this),
      base::InputGroup::driver);
  add("short_a", "", 0.0, 1.0, Set::bind<&Self::set_phase_fault<&Faults::shorted, 0>>(*this),
      base::InputGroup::driver);
  add("short_b", "", 0.0, 1.0, Set::bind<&Self::set_phase_fault<&Faults::shorted, 1>>(*this),
      base::InputGroup::driver);
  add("short_high_side", "", 0.0, 1.0, Set::bind<&Self::set_high_side_short>(*this),
      base::InputGroup::driver);
  if (has(AxisPart::encoder)) {
    add("encoder_counts_lost", "count", -1e6, 1e6, Set::bind<&Self::lose_counts>(*this),
        base::InputGroup::sensors);
  }
  fault_inputs_.append(inputs, prefix);
}

}  // namespace stator::plant
