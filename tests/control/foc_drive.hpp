#pragma once

#include <cmath>
#include <cstdint>

#include "stator/control/foc/foc_block.hpp"
#include "stator/plant/axes/servo_axis.hpp"

namespace stator::control::foc {

/// A FOC block with a power stage and a motor: raw currents of 1 mA per step about 32768 (delta
/// sigma), an encoder at the first ABN interface, Hall sensors.
class FocDrive {
 public:
  /// A linear motor without friction on a stiff 24 V supply.
  static plant::ServoAxisParameters linear_axis() {
    plant::ServoAxisParameters result;
    result.motor = {};
    result.motor.coulomb_friction = result.motor.static_friction = 0.0;
    result.motor.resistance_coefficient = result.motor.flux_coefficient = 0.0;
    result.supply = {.capacitance = 0.0, .source_resistance = 0.0};
    result.inverter.on_resistance = 1e-9;
    result.inverter.pwm_frequency = 50e3;
    result.encoder.counts_per_revolution = 4096;
    result.encoder.offset = 0.0;
    return result;
  }

  explicit FocDrive(const plant::ServoAxisParameters& parameters = linear_axis(),
                    std::int32_t maxcnt = 1999)
      : axis(parameters) {
    block.set(field("PWM_MAXCNT"), maxcnt);
    block.set(field("PWM_SV"), 1);
    block.set(field("PWM_CHOP"), 7);
    block.set(field("CFG_DSMODULATOR_A"), 1);
    block.set(field("ADC_I0_OFFSET"), 32768);
    block.set(field("ADC_I1_OFFSET"), 32768);
    block.set(field("MOTOR_TYPE"), 3);
    block.set(field("N_POLE_PAIRS"), parameters.motor.pole_pairs);
    block.set(field("ABN_DECODER_PPR"), parameters.encoder.counts_per_revolution);
    block.set(field("PIDOUT_UQ_UD_LIMITS"), 32767);
    block.set(field("MODE_PID_TYPE"), 1);
    block.set(field("PHI_E_SELECTION"), 3);
    block.set(field("VELOCITY_SELECTION"), 9);
    block.set(field("POSITION_SELECTION"), 9);
    block.step(inputs());  // learns where the encoder stands
  }

  /// Register values of a pole-zero-cancelling current loop: `bandwidth` is wc Ts.
  void tune_currents(double bandwidth) {
    const double period = block.period() * 1e-8;
    const double unit = axis.sensing().supply_voltage / std::sqrt(3.0) / 32768.0;  // V
    const auto& motor = axis.parameters().motor;
    const double p = 256.0 * motor.quadrature_inductance * bandwidth / period * 1e-3 / unit;
    const double i = 32768.0 * period * motor.resistance / motor.quadrature_inductance;
    for (const Field& f : {field("PID_TORQUE_P"), field("PID_FLUX_P")}) {
      block.set(f, std::lround(p));
    }
    for (const Field& f : {field("PID_TORQUE_I"), field("PID_FLUX_I")}) {
      block.set(f, std::lround(i));
    }
  }

  void step() {
    const Outputs& outputs = block.step(inputs());
    base::ServoActuation actuation;
    actuation.bridge_enabled = outputs.enable && outputs.pwm.chopper == Chopper::centred;
    for (unsigned k = 0; k < 3; ++k) {
      actuation.duty[k] =
          static_cast<double>(outputs.pwm.on_time[k]) / static_cast<double>(outputs.pwm.period);
    }
    axis.step(actuation, base::SimDuration(outputs.pwm.period * 10LL));
  }
  void run(double seconds) {
    const auto periods = static_cast<std::int64_t>(seconds / (block.period() * 1e-8) + 0.5);
    for (std::int64_t k = 0; k < periods; ++k) {
      step();
    }
  }
  [[nodiscard]] double iq() const { return axis.observe().quadrature_current; }
  [[nodiscard]] double id() const { return axis.observe().direct_current; }
  [[nodiscard]] double rpm() const { return axis.observe().speed * 30.0 / M_PI; }

  FocBlock block;
  plant::ServoAxis axis;
  bool encoder_swapped = false;  ///< A and B are exchanged

 private:
  [[nodiscard]] Inputs inputs() const {
    const base::ServoSensing& sensing = axis.sensing();
    Inputs result;
    const auto raw = [](double ampere) {
      return static_cast<std::uint16_t>(std::lround(32768.0 + 1000.0 * ampere));
    };
    result.delta_sigma_a.current = {raw(sensing.phase_current[0]), raw(sensing.phase_current[2])};
    result.abn.count = encoder_swapped ? -sensing.encoder_count : sensing.encoder_count;
    result.abn.passages = sensing.encoder_index_passages;
    result.abn.n_count = sensing.encoder_index_count;
    result.halls = sensing.halls;
    return result;
  }
};

}  // namespace stator::control::foc
