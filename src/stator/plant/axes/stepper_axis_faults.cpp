#include "stator/plant/axes/stepper_axis.hpp"

// What a test or an operator does to an axis, and what its sensors make of it.

namespace stator::plant {

void StepperAxis::set_supply_voltage(double voltage) {
  state_.fault_state.supply_voltage = voltage;
  feed(state_.supply, supply_.ideal(), state_.faults.common.supply, voltage);
  settled_ = false;
}

void StepperAxis::set_faults(const StepperAxisFaults& faults) {
  if (faults.common.shaft != state_.faults.common.shaft) {
    state_.fault_state.note_jam(faults.common.shaft, motor_.revolutions(state_.motor));
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
  sense_into(sensing_);
  if (spoiled_) {
    spoil_sensors();
  }
}

void StepperAxis::apply_faults() {
  const AxisFaults& common = state_.faults.common;
  StepperAxisFaults electrical = state_.faults;
  electrical.common = {};
  faulty_ = electrical != StepperAxisFaults{};
  spoiled_ = common.heat.driver_reading != 0.0 || common.switches != AxisFaults{}.switches ||
             common.encoders[0] != EncoderFaults{};
  motor_.set_load(faulted(parameters_.load, common.shaft, state_.fault_state));
  electrical_per_torque_ = parameters_.motor.pole_pairs / motor_.inertia();
  supply_ = Supply(faulted(parameters_.supply, common.supply));
  encoder_.set_slipped(state_.fault_state.encoders[0].slipped);
  settled_ = false;
}

void StepperAxis::restore(const StepperAxisState& state) {
  state_ = state;
  apply_faults();
  follow_winding_temperature();
}

void StepperAxis::lose_encoder_counts(std::int64_t counts) {
  lose_counts(parameters_.encoder, state_.encoder, counts);
  begin_faults(state_.fault_state.encoders[0], state_.encoder, state_.motor.angle);
  settled_ = false;
}

void StepperAxis::spoil_encoder() {
  spoil(state_.fault_state.encoders[0], state_.faults.common.encoders[0], encoder_, state_.encoder,
        state_.motor.angle, motor_.electromagnetic_torque(state_.motor));
}

void StepperAxis::spoil_sensors() {
  const AxisFaults& common = state_.faults.common;
  sensing_.driver_temperature += common.heat.driver_reading;
  sensing_.left_switch = parameters_.left_switch.through(common.switches[0], sensing_.left_switch);
  sensing_.right_switch =
      parameters_.right_switch.through(common.switches[1], sensing_.right_switch);
  sensing_.home_switch = parameters_.home_switch.through(common.switches[2], sensing_.home_switch);
  const EncoderFaults& encoder = common.encoders[0];
  if (encoder.index_lost) {
    sensing_.encoder_index = parameters_.encoder.index_active_low;
  }
  if (encoder.noise >= 1.0 && parameters_.encoder.counts_per_revolution > 0) {
    sensing_.encoder_count += noise(state_.fault_state.encoders[0], encoder);
    settled_ = false;  // the next reading is another one
  }
}

}  // namespace stator::plant
