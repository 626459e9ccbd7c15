#include <cmath>

#include "stator/plant/axes/pwm_axis.hpp"

// What a test or an operator does to an axis, and what its sensors make of it.

namespace stator::plant {

void PwmAxis::set_supply_voltage(double voltage) {
  fault_state_.supply_voltage = voltage;
  feed(supply_state_, supply_.ideal(), faults_.common.supply, voltage);
}

void PwmAxis::set_faults(const PwmAxisFaults& faults) {
  const AxisFaults& common = faults.common;
  if (common.shaft != faults_.common.shaft) {
    fault_state_.note_jam(common.shaft, revolutions());
  }
  begin_encoder_faults();
  const SupplyFaults before = faults_.common.supply;
  faults_ = faults;
  PwmAxisFaults electrical = faults;
  electrical.common = {};
  electrical.converter_noise = 0.0;
  faulty_ = electrical != PwmAxisFaults{};
  spoiled_ = common.encoders != AxisFaults{}.encoders;
  supply_ = Supply(faulted(parameters_.supply, common.supply));
  feed(supply_state_, supply_.ideal(), before, common.supply, fault_state_.supply_voltage);
  std::visit(
      [&](auto& winding) {
        winding.set_faults(faults.terminals);
        winding.set_load(faulted(parameters_.load, common.shaft, fault_state_));
        if (common.shaft.jam == Jam::blocked) {
          winding.stop();
        }
      },
      winding_);
  ConverterParameters converter = parameters_.converter;
  for (auto& channel : converter.currents) {
    channel.noise =
        std::sqrt(channel.noise * channel.noise + faults.converter_noise * faults.converter_noise);
  }
  converter_ = CurrentConverter(converter);
  if (!faulty_) {
    sensing_.overcurrent = {};
    sensing_.overcurrent_high_side = false;
  }
  sensing_.driver_temperature = stage_temperature_.inner + common.heat.driver_reading;
  sensing_.winding_temperature = motor_temperature_.inner;
  sense_switches();
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
  const auto level = [&](const PositionSwitch& position_switch, bool by_hand, std::size_t which) {
    return position_switch.through(faults_.common.switches[which],
                                   position_switch.level(at, by_hand));
  };
  sensing_.left_switch = level(parameters_.left_switch, left_by_hand_, 0);
  sensing_.right_switch = level(parameters_.right_switch, right_by_hand_, 1);
  sensing_.home_switch = level(parameters_.home_switch, home_by_hand_, 2);
}

void PwmAxis::sense_faults(bool bridge_enabled) {
  for (std::size_t k = 0; k < sensing_.overcurrent.size(); ++k) {
    sensing_.overcurrent[k] = bridge_enabled && faults_.terminals.grounded[k];
  }
  sensing_.overcurrent_high_side = bridge_enabled && faults_.high_side;
}

void PwmAxis::begin_encoder_faults() {
  const ElectricalAngle& angle = std::visit(
      [](const auto& winding) -> const ElectricalAngle& { return winding.angle(); }, winding_);
  for (std::size_t k = 0; k < encoders_.size(); ++k) {
    begin_faults(fault_state_.encoders[k], encoder_states_[k], angle);
  }
}

void PwmAxis::spoil_encoder(std::size_t encoder, const ElectricalAngle& angle, double torque) {
  spoil(fault_state_.encoders[encoder], faults_.common.encoders[encoder], encoders_[encoder],
        encoder_states_[encoder], angle, torque);
}

}  // namespace stator::plant
