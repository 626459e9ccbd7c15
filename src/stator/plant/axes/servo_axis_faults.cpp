#include <cmath>

#include "stator/plant/axes/servo_axis.hpp"

// What a test or an operator does to an axis, and what its sensors make of it.

namespace stator::plant {

void ServoAxis::set_supply_voltage(double voltage) {
  state_.fault_state.supply_voltage = voltage;
  feed(state_.supply, supply_.ideal(), state_.faults.common.supply, voltage);
  settled_ = false;
}

void ServoAxis::set_faults(const ServoAxisFaults& faults) {
  if (faults.common.shaft != state_.faults.common.shaft) {
    state_.fault_state.note_jam(faults.common.shaft,
                                motor_.shaft().revolutions(state_.motor.angle));
    if (faults.common.shaft.jam == Jam::blocked) {
      state_.motor.speed = 0.0;
    }
  }
  begin_faults(state_.fault_state.encoders[0], state_.encoder, state_.motor.angle);
  const SupplyFaults before = state_.faults.common.supply;
  state_.faults = faults;
  apply_faults();
  feed(state_.supply, supply_.ideal(), before, faults.common.supply,
       state_.fault_state.supply_voltage);
  sensing_.driver_temperature = state_.stage_temperature.inner + faults.common.heat.driver_reading;
  sense_switches();
}

void ServoAxis::apply_faults() {
  const AxisFaults& common = state_.faults.common;
  ServoAxisFaults electrical = state_.faults;
  electrical.common = {};
  electrical.current_noise = 0.0;
  faulty_ = electrical != ServoAxisFaults{};
  spoiled_ = common.encoders[0] != EncoderFaults{};
  motor_.set_load(faulted(parameters_.load, common.shaft, state_.fault_state));
  supply_ = Supply(faulted(parameters_.supply, common.supply));
  CurrentSensingParameters sensing = parameters_.current_sensing;
  const double noise = state_.faults.current_noise;
  sensing.noise = std::sqrt(sensing.noise * sensing.noise + noise * noise);
  current_sensing_ = CurrentSensing(sensing);
  encoder_.set_slipped(state_.fault_state.encoders[0].slipped);
  plain_ = !faulty_ && parameters_.inverter.dead_time <= 0.0 && motor_.may_turn_freely();
  settled_ = false;
}

void ServoAxis::restore(const ServoAxisState& state) {
  state_ = state;
  apply_faults();
  motor_.set_temperatures(state.motor_temperature.inner, state.motor_temperature.outer);
  sensing_ = {};
  sensing_.driver_temperature =
      state.stage_temperature.inner + state.faults.common.heat.driver_reading;
  sense_switches();
  sense();
  // The next samples are those that follow the snapshot.
  state_.noise = state.noise;
  state_.fault_state = state.fault_state;
}

void ServoAxis::lose_encoder_counts(std::int64_t counts) {
  lose_counts(parameters_.encoder, state_.encoder, counts);
  begin_faults(state_.fault_state.encoders[0], state_.encoder, state_.motor.angle);
  settled_ = false;
}

void ServoAxis::sense_switches() {
  const double revolutions = motor_.shaft().revolutions(state_.motor.angle);
  const auto level = [&](const PositionSwitch& position_switch, bool by_hand, std::size_t which) {
    return position_switch.through(state_.faults.common.switches[which],
                                   position_switch.level(revolutions, by_hand));
  };
  sensing_.left_switch = level(parameters_.left_switch, state_.left_by_hand, 0);
  sensing_.right_switch = level(parameters_.right_switch, state_.right_by_hand, 1);
  sensing_.home_switch = level(parameters_.home_switch, state_.home_by_hand, 2);
}

void ServoAxis::press(bool& by_hand, bool pressed) {
  by_hand = pressed;
  sense_switches();
}

void ServoAxis::spoil_encoder() {
  spoil(state_.fault_state.encoders[0], state_.faults.common.encoders[0], encoder_, state_.encoder,
        state_.motor.angle, motor_.electromagnetic_torque(state_.motor));
}

void ServoAxis::spoil_encoder_reading() {
  const EncoderFaults& faults = state_.faults.common.encoders[0];
  if (faults.index_lost) {
    sensing_.encoder_index = parameters_.encoder.index_active_low;
  }
  if (parameters_.encoder.counts_per_revolution > 0) {
    sensing_.encoder_count += noise(state_.fault_state.encoders[0], faults);
  }
}

}  // namespace stator::plant
