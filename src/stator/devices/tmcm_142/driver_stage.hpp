#pragma once

#include <array>
#include <cstdint>

#include "stator/base/axis_signals.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/drive/stepper/driver_chip.hpp"
#include "stator/drive/stepper/stepper_settings.hpp"

namespace stator::devices::tmcm_142 {

/// What the motion controller and the axis parameters want of the power stage for one period.
struct StageInput {
  bool enabled = false;            ///< supply and shutdown pin let it work
  std::array<double, 2> phases{};  ///< parts of the current scale, -1..1
  std::uint8_t scale = 0;          ///< 0..15, of parameters 6 and 7
  double full_steps_per_second = 0.0;
  bool standing = true;
  bool mixed_decay_run = true;         ///< parameter 21
  bool mixed_decay_standby = true;     ///< parameter 22
  std::int32_t chopper_divider = 444;  ///< parameter 23
  double resistance = 0.8;             ///< ohm, of a phase
};

/// The discrete power stage of the module with its driver chip (TMC239 or TMC249: A97): 7 A peak at
/// full scale (A102), load measurement, protection.
///
/// A short switches the stage off for kRetryTime, then it tries again; too high a temperature or a
/// supply outside of its range for as long as that lasts (A46). Without mixed decay the current
/// does not come below what the shortest pulse of the chopper feeds, duty times supply over
/// resistance (L6156-L6158, L6166-L6168): parameter 21 chooses for a running motor, 22 for a
/// standing one, which so stands beside its microstep and gets warmer.
class DriverStage {
 public:
  static constexpr double kFullScaleCurrent = 7.0;  ///< A, peak (L46)
  static constexpr std::uint8_t kFullScale = 15;    ///< of parameters 6 and 7
  static constexpr double kMinimumSupply = 18.0;    ///< V (L45)
  static constexpr double kMaximumSupply = 78.5;    ///< V
  static constexpr base::SimDuration kRetryTime{5'000'000};
  static constexpr base::SimDuration kSupervisionPeriod{1'000'000};

  DriverStage();

  /// What the stage does in the period to come; `sensing` is of its begin.
  [[nodiscard]] base::AxisActuation advance(const StageInput& input,
                                            const base::AxisSensing& sensing,
                                            base::SimDuration period);
  /// As after power-on.
  void restart() { *this = DriverStage(); }

  /// Parameter 25: 7 = low load, 0 = high load or nothing to measure; eighths of the EMF that the
  /// load leaves unused, taken over a full step.
  [[nodiscard]] std::uint8_t load_value() const {
    return static_cast<std::uint8_t>(chip_.stall_guard() >> 7U);
  }
  /// Parameter 26, bit 0, and ALARM.
  [[nodiscard]] bool error() const { return error_; }
  /// Parameter 26, bit 1.
  [[nodiscard]] bool over_temperature_warning() const {
    return chip_.flags().has(drive::AxisError::over_temperature_warning);
  }
  /// The errors that the chip reports.
  [[nodiscard]] const drive::AxisErrors& flags() const { return shown_; }
  [[nodiscard]] bool overvoltage() const { return overvoltage_; }

 private:
  void supervise(const base::AxisSensing& sensing);

  drive::StepperSettings settings_;
  drive::DriverChip chip_;
  base::SimDuration since_supervision_;
  base::SimDuration since_retry_;
  drive::AxisErrors shown_;
  bool overvoltage_ = false;
  bool error_ = false;
};

}  // namespace stator::devices::tmcm_142
