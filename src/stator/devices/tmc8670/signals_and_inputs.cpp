// What of a TMC8670 can be recorded, and what of its surroundings can be set.

#include "stator/devices/tmc8670/tmc8670.hpp"

namespace stator::devices {

std::vector<product::Signal> Tmc8670::signals() const {
  std::vector<product::Signal> signals;
  axis_.append_signals(signals);
  using Read = base::SignalReader;
  signals.push_back({"led_run", "", Read::bind<&Tmc8670::led_run>(*this)});
  signals.push_back({"led_error", "", Read::bind<&Tmc8670::led_error>(*this)});
  signals.push_back({"led_link_in", "", Read::bind<&Tmc8670::led_link<0>>(*this)});
  signals.push_back({"led_link_out", "", Read::bind<&Tmc8670::led_link<1>>(*this)});
  signals.push_back({"link_pin_in", "", Read::bind<&Tmc8670::link_pin<0>>(*this)});
  signals.push_back({"link_pin_out", "", Read::bind<&Tmc8670::link_pin<1>>(*this)});
  return signals;
}

std::vector<product::Input> Tmc8670::inputs() {
  std::vector<product::Input> inputs;
  axis_.append_inputs(inputs);
  append_port_inputs(inputs);
  using Set = base::Delegate<void(double)>;
  inputs.emplace_back("supply_3v3", "V", -1.0, 6.0, Set::bind<&Tmc8670::set_logic_supply<0>>(*this),
                      product::InputGroup::supply, 3.3);
  inputs.emplace_back("supply_1v2", "V", -1.0, 6.0, Set::bind<&Tmc8670::set_logic_supply<1>>(*this),
                      product::InputGroup::supply, 1.2);
  inputs.push_back(clock_deviation_input());
  return inputs;
}

void Tmc8670::append_port_inputs(std::vector<product::Input>& inputs) {
  using Set = base::Delegate<void(double)>;
  // -1: driven by the PHY, 0: low, 1: high
  inputs.emplace_back("link_pin_in", "", -1.0, 1.0, Set::bind<&Tmc8670::hold_link_pin<0>>(*this),
                      product::InputGroup::network, -1.0);
  inputs.emplace_back("link_pin_out", "", -1.0, 1.0, Set::bind<&Tmc8670::hold_link_pin<1>>(*this),
                      product::InputGroup::network, -1.0);
  // 0: all an EtherCAT port needs, 1: 10 Mbit/s, 2: half duplex, 3: no negotiation
  inputs.emplace_back("link_partner_in", "", 0.0, 3.0,
                      Set::bind<&Tmc8670::set_link_partner<0>>(*this),
                      product::InputGroup::network);
  inputs.emplace_back("link_partner_out", "", 0.0, 3.0,
                      Set::bind<&Tmc8670::set_link_partner<1>>(*this),
                      product::InputGroup::network);
}

}  // namespace stator::devices
