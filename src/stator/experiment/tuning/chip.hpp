#pragma once

#include <cstdint>

#include "stator/control/foc/register_fields.hpp"
#include "stator/experiment/tuning/settings.hpp"
#include "stator/product/catalogue/tuning.hpp"

namespace stator::experiment::tuning {

/// Currents and voltages in the frame the block uses for commutation, and the supply.
struct Sample {
  double id = 0.0;      ///< A
  double iq = 0.0;      ///< A
  double ud = 0.0;      ///< V, as applied from the period after next's begin
  double uq = 0.0;      ///< V
  double supply = 0.0;  ///< V
};

/// A servo stage as a tuning tool has it: registers to read and write between PWM periods, the pins
/// for power stage and brake, and what the maker of the board says of its converters. The motor is
/// behind the registers; nothing here looks at the plant.
class Chip {
 public:
  Chip(product::TuningStage& stage, const Settings& settings);

  [[nodiscard]] std::int32_t get(const control::foc::Field& f) const { return stage_->get(f); }
  void set(const control::foc::Field& f, std::int64_t value) { stage_->set(f, value); }

  /// One PWM period; follows the encoder.
  void step();
  /// PWM periods for at least `seconds`.
  void run(double seconds);
  /// That many PWM periods, at least one.
  [[nodiscard]] int periods(double seconds) const;

  /// The power stage with all transistors off, or switching with what the registers say.
  void enable(bool on);
  /// Voltage mode with the angle `phi` (s16) from PHI_E_EXT.
  void hold_field(std::int32_t phi);
  /// Voltage mode with the angle of the open-loop generator, from the angle it has now.
  void turn_field();
  /// Current loops with the angle 0, `flux` steps of current along it.
  void hold_current(std::int64_t flux);
  /// Closed loops with the angle of the encoder; `mode` as in MODE_MOTION.
  void close_loop(std::int32_t mode);
  /// U_D of the voltage modes, in the register's unit.
  void set_voltage(std::int64_t ud, std::int64_t uq = 0);

  [[nodiscard]] Sample sample() const;
  [[nodiscard]] double phase_current(int phase) const;  ///< A; 0, 1, 2: U/X, V, W/Y
  [[nodiscard]] double supply() const;                  ///< V
  /// A converter stood at the end of its range since the last call.
  bool take_clipped();

  /// Encoder counts since the tool began, not wrapped.
  [[nodiscard]] std::int64_t count() const { return count_; }
  /// Counts at the latest N pulse; `take_index` tells whether there was one since the last call.
  [[nodiscard]] std::int64_t index_count() const { return index_count_; }
  [[nodiscard]] bool take_index();
  /// Sets what the encoder has been found to be: from now on count() has that direction and the
  /// counter shows it modulo `resolution`, as it would if it had been set so at power-on.
  void set_encoder(std::int32_t resolution, bool reversed);

  [[nodiscard]] double period() const;                             ///< s
  [[nodiscard]] double ampere() const { return ampere_; }          ///< of a step of the currents
  [[nodiscard]] double volt() const { return volt_at(supply()); }  ///< of a step of the voltages
  [[nodiscard]] double volt_at(double supply) const { return supply * volt_share_; }
  /// Torque of a current vector: N m/A by V s of flux linkage and pole pair.
  [[nodiscard]] double torque_factor() const { return torque_factor_; }
  [[nodiscard]] const Settings& settings() const { return settings_; }
  void report(std::string_view text) const { settings_.report(text); }

 private:
  void follow_encoder();

  product::TuningStage* stage_;
  Settings settings_;
  double ampere_;
  double volt_share_;
  double torque_factor_;
  std::int32_t resolution_ = 0xFFFFFF;
  std::int64_t count_ = 0;
  std::int64_t index_count_ = 0;
  std::int32_t shown_ = 0;  ///< ABN_DECODER_COUNT
  bool index_ = false;
};

}  // namespace stator::experiment::tuning
