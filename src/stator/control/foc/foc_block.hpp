#pragma once

#include <cstdint>

#include "stator/control/foc/adc_engine.hpp"
#include "stator/control/foc/circular_limiter.hpp"
#include "stator/control/foc/control_cascade.hpp"
#include "stator/control/foc/encoder_initialisation.hpp"
#include "stator/control/foc/peripherals.hpp"
#include "stator/control/foc/pwm_engine.hpp"
#include "stator/control/foc/register_file.hpp"
#include "stator/control/foc/sensor_engine.hpp"
#include "stator/control/foc/signals.hpp"

namespace stator::control::foc {

/// The FOC block of a TMC8670 behind its registers: 7-bit addresses, 32-bit words.
///
/// step() is one PWM period. It begins with the on-times computed in the period before, samples
/// what comes to the pins at that moment, and computes the on-times of the period that follows:
/// with the zero-order hold of the bridge the current loop has a dead time of 1.5 periods.
/// Registers may be read and written between steps, at any rate; a write acts from the next step
/// on. The block is a value: a copy is a snapshot.
class FocBlock {
 public:
  FocBlock();

  /// Content of the register; of data registers the view that their address register chooses.
  /// 0 where there is none.
  [[nodiscard]] std::uint32_t read(std::uint8_t address) const;
  /// Writes what is writable of the register; false if nothing is.
  bool write(std::uint8_t address, std::uint32_t value);
  /// Value of one field, of any view, with its sign.
  [[nodiscard]] std::int32_t get(const Field& f) const {
    return extract(read_view(f.address, f.view), f);
  }
  /// Writes one field of a register or of a view of CONFIG_DATA, its neighbours stay.
  void set(const Field& f, std::int64_t value);

  /// One PWM period; see period().
  const Outputs& step(const Inputs& inputs);
  /// Ticks of 10 ns of the period that the next step() begins: PWM_MAXCNT + 1.
  [[nodiscard]] std::int32_t period() const { return pwm_.period(); }

  /// HALL_DIG_FILTER in 5 us, for which no register is known. 0 after power-on.
  void set_hall_filter(std::int32_t value);

  [[nodiscard]] const Outputs& outputs() const { return outputs_; }
  [[nodiscard]] const PwmEngine& pwm() const { return pwm_; }
  [[nodiscard]] const SensorEngine& sensors() const { return sensors_; }

 private:
  [[nodiscard]] std::uint32_t read_view(std::uint8_t address, std::int16_t view) const;
  [[nodiscard]] std::int16_t selected_view(std::uint8_t address) const;
  [[nodiscard]] std::uint32_t read_adc_raw(std::int16_t view) const;
  [[nodiscard]] std::uint32_t read_error(std::int16_t view) const;
  [[nodiscard]] std::uint32_t read_interim(std::int16_t view) const;
  [[nodiscard]] std::uint32_t read_initialisation(std::int16_t view) const;
  [[nodiscard]] std::uint32_t read_sensors(std::uint8_t address) const;
  [[nodiscard]] std::uint32_t read_inputs() const;
  bool write_view(std::uint8_t address, std::int16_t view, std::uint32_t value);
  /// Writes that change state instead of a stored word.
  bool write_state(std::uint8_t address, std::uint32_t value);
  void write_abn_angles(std::uint32_t value);
  void configure();
  void configure_motion();

  void take_steps(const Inputs& inputs);
  [[nodiscard]] Targets other_targets(const Inputs& inputs);
  void measure(const SineCosine& direction);
  [[nodiscard]] RotorVector wanted_voltage(const Inputs& inputs);
  void apply(const RotorVector& wanted, const SineCosine& direction);
  void initialise_by_halls();
  void move_minimally();
  /// Sets the status flags of what happens rarely.
  void note_events();
  void supervise(const Inputs& inputs);

  RegisterFile registers_;
  AdcEngine adc_;
  SensorEngine sensors_;
  ControlCascade cascade_;
  PwmEngine pwm_;
  BrakeChopper brake_chopper_;
  ReferenceSwitches switches_;
  SinglePinInterface single_pin_;
  PseudoRandomSequence noise_;
  HallInitialisation hall_initialisation_;
  MinimalMovement minimal_movement_;

  MotionMode mode_;
  std::int32_t voltage_limit_ = 23169;
  RotorVector external_voltage_;  ///< UD_EXT, UQ_EXT
  Targets targets_;               ///< as the registers hold them
  std::int32_t step_width_ = 0;
  std::uint32_t steps_seen_ = 0;
  std::uint32_t status_mask_ = 0;
  std::uint32_t flags_ = 0;  ///< STATUS_FLAGS
  std::int32_t hall_filter_ = 0;
  std::int32_t abn_angle_ = 0;  ///< ABN phi_e at the latest step of the initialisation

  StatorVector stator_current_;
  RotorVector current_;
  RotorVector wanted_voltage_;
  RotorVector voltage_;
  StatorVector stator_voltage_;
  PhaseVector phase_voltage_;
  PinLevels pins_;
  Outputs outputs_;
};

}  // namespace stator::control::foc
