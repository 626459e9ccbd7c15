#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

#include "devices/tmc8670_linear_drive.hpp"
#include "stator/control/foc/register_fields.hpp"
#include "stator/devices/tmc8670/servo_stage.hpp"

namespace stator::devices::tmc8670 {

using control::foc::field;
using control::foc::Field;

/// The FOC block on its plant, at 50 kHz, as registers set it up: raw currents of 1 mA per step
/// about 32768, an encoder of 65536 counts at the first ABN interface.
class StageBench {
 public:
  static constexpr double kPeriod = 20e-6;
  static constexpr double kSupply = 24.0;

  /// `motor` on a stiff supply without losses in transistors.
  static plant::PwmAxisParameters stiff(const plant::MotorParameters& motor) {
    plant::PwmAxisParameters result;
    result.motor = motor;
    result.supply = {.capacitance = 0.0, .source_resistance = 0.0};
    result.supply_voltage = kSupply;
    result.inverter.on_resistance = 1e-9;
    result.inverter.pwm_frequency = 1.0 / kPeriod;
    result.encoders[0] = {.counts_per_revolution = 65536};
    result.encoders[0].offset = 0.0;
    return result;
  }
  /// A motor that formulas know: no dry friction, no cogging, neither warm nor cold.
  static plant::ThreePhaseMotorParameters textbook_motor() {
    plant::ThreePhaseMotorParameters motor;
    motor.coulomb_friction = motor.static_friction = 0.0;
    motor.resistance_coefficient = motor.flux_coefficient = 0.0;
    return motor;
  }

  StageBench(const plant::PwmAxisParameters& parameters, std::int32_t motor_type,
             std::int32_t pole_pairs)
      : stage(parameters) {
    set(field("PWM_MAXCNT"), 1999);
    set(field("PWM_SV"), motor_type == 3 ? 1 : 0);
    set(field("PWM_CHOP"), 7);
    set(field("CFG_DSMODULATOR_A"), 1);
    set(field("ADC_I0_OFFSET"), 32768);
    set(field("ADC_I1_OFFSET"), 32768);
    set(field("MOTOR_TYPE"), motor_type);
    set(field("N_POLE_PAIRS"), pole_pairs);
    set(field("ABN_DECODER_PPR"), 65536);
    set(field("PIDOUT_UQ_UD_LIMITS"), 32767);
    set(field("PID_TORQUE_FLUX_LIMITS"), 30000);
    set(field("MODE_PID_TYPE"), 1);
    set(field("PHI_E_SELECTION"), 3);
    set(field("VELOCITY_SELECTION"), 9);
    set(field("POSITION_SELECTION"), 9);
    set(field("PWM_BBM_H"), 0);  // linear: no dead time
    set(field("PWM_BBM_L"), 0);
    stage.set_enable(true);
    stage.set_brake_released(true);
    stage.step();  // learns where the encoder stands
  }

  void set(const Field& f, std::int64_t value) { stage.block().set(f, value); }
  [[nodiscard]] std::int32_t get(const Field& f) const { return stage.block().get(f); }
  /// V per step of a voltage word.
  [[nodiscard]] static double voltage_unit(std::int32_t motor_type) {
    return (motor_type == 3 ? kSupply / std::sqrt(3.0) : kSupply) / 32768.0;
  }

  /// Current loops with pole and zero cancelled, closed with `g` = wc Ts. Returns the gains that
  /// the registers hold.
  LoopGains tune_currents(double g, double resistance, double inductance,
                          std::int32_t motor_type = 3) {
    const double unit = voltage_unit(motor_type);
    const std::int64_t p = std::lround(256.0 * inductance * g / kPeriod * 1e-3 / unit);
    const std::int64_t i = std::lround(32768.0 * kPeriod * resistance / inductance);
    set(field("PID_TORQUE_P"), p);
    set(field("PID_FLUX_P"), p);
    set(field("PID_TORQUE_I"), i);
    set(field("PID_FLUX_I"), i);
    gains_.current = static_cast<double>(p) / 256.0 * unit * 1e3;
    gains_.current_integral = static_cast<double>(i) / 32768.0;
    return gains_;
  }
  /// Register values of velocity and position loop; the gains they are in SI units.
  LoopGains tune_outer(std::int32_t velocity_p, std::int32_t velocity_i, std::int32_t position_p) {
    set(field("PID_VELOCITY_P"), velocity_p);
    set(field("PID_VELOCITY_I"), velocity_i);
    set(field("PID_POSITION_P"), position_p);
    gains_.velocity = velocity_p / 256.0 * 1e-3 * 60.0 / (2.0 * M_PI);
    gains_.velocity_integral = velocity_i / 32768.0;
    gains_.position = position_p / 4096.0 * 65536.0 / 60.0;
    return gains_;
  }

  void run(double seconds) {
    for (std::int64_t n = std::llround(seconds / kPeriod); n > 0; --n) {
      stage.step();
    }
  }
  [[nodiscard]] plant::PwmAxisObservation seen() const { return stage.plant().observe(); }

  ServoStage stage;

 private:
  LoopGains gains_;
};

}  // namespace stator::devices::tmc8670
