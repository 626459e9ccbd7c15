#include "plant/pwm_axis.hpp"

// What a test or an operator does to an axis, and what its sensors make of it.

namespace stator::plant {

void PwmAxis::set_supply_voltage(double voltage) {
  supply_state_.source = voltage;
  if (supply_.ideal()) {
    supply_state_.voltage = voltage;
  }
}

void PwmAxis::set_faults(const PwmAxisFaults& faults) {
  faults_ = faults;
  faulty_ = faults != PwmAxisFaults{};
  std::visit(
      [&faults](auto& winding) {
        winding.set_faults(faults.terminals);
        winding.jam(faults.jamming_torque);
      },
      winding_);
  if (!faulty_) {
    sensing_.overcurrent = {};
    sensing_.overcurrent_high_side = false;
  }
}

void PwmAxis::lose_encoder_counts(std::size_t encoder, std::int64_t counts) {
  disturbance_states_[encoder].lost += counts;
}

void PwmAxis::press(bool& by_hand, bool pressed) {
  by_hand = pressed;
  sense_switches();
}

void PwmAxis::sense_switches() {
  const double at = revolutions();
  sensing_.left_switch = parameters_.left_switch.level(at, left_by_hand_);
  sensing_.right_switch = parameters_.right_switch.level(at, right_by_hand_);
  sensing_.home_switch = parameters_.home_switch.level(at, home_by_hand_);
}

void PwmAxis::sense_faults(bool bridge_enabled) {
  for (std::size_t k = 0; k < sensing_.overcurrent.size(); ++k) {
    sensing_.overcurrent[k] = bridge_enabled && faults_.terminals.grounded[k];
  }
  sensing_.overcurrent_high_side = bridge_enabled && faults_.high_side;
}

}  // namespace stator::plant
