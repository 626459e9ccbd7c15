#include "stator/devices/tmc8670/servo_stage.hpp"

#include <cstddef>

namespace stator::devices::tmc8670 {

namespace {

using control::foc::AbnSignals;
using control::foc::Chopper;
using control::foc::CurrentGroup;
using control::foc::EncoderGroup;
using control::foc::PwmPeriod;

void wire(AbnSignals& signals, const plant::EncoderReading& reading) {
  signals.count = reading.count;
  signals.passages = reading.index_passages;
  signals.n_count = reading.index_count;
  signals.n = reading.index;
}

/// The same raw values at either input. One by one: a group that is copied as a whole waits for the
/// words of which it has just been made.
void wire(CurrentGroup& group, const plant::ConverterSample& sample) {
  group.current[0] = sample.currents[0];
  group.current[1] = sample.currents[1];
  group.motor_supply = sample.voltage;
}
void wire(EncoderGroup& group, std::uint16_t ux, std::uint16_t vn, std::uint16_t wy) {
  group.ux = ux;
  group.vn = vn;
  group.wy = wy;
}

/// Of a sine/cosine encoder the third track is N; analog Hall sensors have one track per phase.
void wire_analog(control::foc::Inputs& inputs, const plant::PwmSensing& sensing,
                 const plant::PwmAxisParameters& parameters) {
  if (parameters.analog_halls.tracks > 0) {
    const auto& [u, v, w] = sensing.analog_halls;
    wire(inputs.delta_sigma_b, u, v, w);
    wire(inputs.spi_b, u, v, w);
  } else if (parameters.analog_encoder.tracks > 0) {
    const auto& [cosine, sine, index] = sensing.analog_encoder;
    wire(inputs.delta_sigma_b, cosine, index, sine);
    wire(inputs.spi_b, cosine, index, sine);
  }
}

constexpr double kSecondsPerTick = 1e-8;

/// Pauses of high and low sides that differ count with their mean.
plant::PwmActuation bridge_of(const PwmPeriod& pwm) {
  plant::PwmActuation actuation;
  switch (pwm.chopper) {
    case Chopper::centred: {
      const double share = 1.0 / pwm.period;
      actuation.bridge_enabled = true;
      actuation.dead_time = 0.5 * kSecondsPerTick * (pwm.pause_high + pwm.pause_low);
      for (std::size_t k = 0; k < pwm.on_time.size(); ++k) {
        actuation.duty[k] = pwm.on_time[k] * share;
      }
      break;
    }
    case Chopper::low_sides_on:
      actuation.bridge_enabled = true;
      break;
    case Chopper::high_sides_on:
      actuation.bridge_enabled = true;
      actuation.duty.fill(1.0);
      break;
    default:  // one side alone drives no motor
      break;
  }
  return actuation;
}

}  // namespace

ServoStage::ServoStage(const plant::PwmAxisParameters& parameters) : plant_(parameters) {
  inputs_.enable = false;
  sample(inputs_);
}

void ServoStage::sample(control::foc::Inputs& inputs) const {
  const plant::PwmSensing& sensing = plant_.sensing();
  inputs.halls = sensing.halls;
  inputs.left_switch = sensing.left_switch;
  inputs.home_switch = sensing.home_switch;
  inputs.right_switch = sensing.right_switch;
  wire(inputs.delta_sigma_a, sensing.converter);
  wire(inputs.spi_a, sensing.converter);
  wire_analog(inputs, sensing, plant_.parameters());
  wire(inputs.abn, sensing.encoders[0]);
  if (plant_.parameters().encoders[1].counts_per_revolution > 0) {
    wire(inputs.abn_2, sensing.encoders[1]);
  }
}

control::foc::Inputs ServoStage::inputs() const {
  control::foc::Inputs inputs = inputs_;
  sample(inputs);
  return inputs;
}

void ServoStage::step() {
  const base::SimDuration duration = period();
  sample(inputs_);
  const control::foc::Outputs& outputs = block_.step(inputs_);
  plant::PwmActuation actuation = bridge_of(outputs.pwm);
  actuation.bridge_enabled &= outputs.enable;
  actuation.brake_released = brake_released_;
  actuation.brake_chopper_on = outputs.brake_chopper;
  plant_.step(actuation, duration);
}

}  // namespace stator::devices::tmc8670
