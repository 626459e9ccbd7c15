#pragma once

#include <cstdint>

#include "stator/base/axis_signals.hpp"
#include "stator/control/stepper/cool_step.hpp"
#include "stator/control/stepper/open_load_detector.hpp"
#include "stator/control/stepper/stall_guard.hpp"
#include "stator/drive/axis/axis_error.hpp"
#include "stator/drive/stepper/stepper_settings.hpp"

namespace stator::drive {

/// The driver chip between sequencer and coils: measures the load, makes current or voltage of what
/// the sequencer wants, watches stage, cable and supply.
///
/// A short switches the stage off until clear_shorts(), too high a temperature until it has cooled
/// down, whatever the firmware wants.
class DriverChip {
 public:
  /// One step: completes what the sequencer wants while the set-point moves at `velocity` (pps).
  /// `sensing` is what was measured at its begin.
  void advance(const StepperSettings& settings, double velocity, base::AxisActuation& actuation,
               const base::AxisSensing& sensing);
  /// Brings the flags of cables, temperature and supply up to date; once per control period.
  void supervise(const DriverLimits& limits);

  /// Open loads, shorts, temperatures and undervoltage as the chip shows them now.
  [[nodiscard]] AxisErrors flags() const { return flags_; }
  /// Whether a stall was met since the last call, in a measurement above the stall velocity.
  [[nodiscard]] bool take_stall() {
    const bool stalled = stalled_;
    stalled_ = false;
    return stalled;
  }
  /// What a fault reset does: the stage may be switched on again.
  void clear_shorts();

  /// Load measurement 0..1023; 0 while nothing is measured.
  [[nodiscard]] std::uint16_t stall_guard() const { return stall_guard_.value(); }
  /// Current scales CoolStep takes from the run current.
  [[nodiscard]] std::uint8_t current_reduction() const { return cool_step_.reduction(); }
  /// StealthChop is at work.
  [[nodiscard]] bool voltage_mode() const { return voltage_mode_; }
  /// The chip lets the coils have current.
  [[nodiscard]] bool conducts() const { return conducts_; }
  /// Current targets of the latest step, A.
  [[nodiscard]] const std::array<double, 2>& current_target() const { return current_target_; }

 private:
  void detect_shorts(const base::AxisSensing& sensing);
  void switch_off();
  void measure(const StepperSettings& settings, double velocity, double speed,
               const base::AxisActuation& actuation, const base::AxisSensing& sensing);
  void stop_measuring();

  control::StallGuard stall_guard_;
  control::CoolStep cool_step_;
  control::OpenLoadDetector open_load_;
  AxisErrors flags_;
  std::array<double, 2> current_target_{};
  double supply_voltage_ = 24.0;  ///< V, as last seen
  double temperature_ = 25.0;     ///< degree Celsius, as last seen
  bool measures_ = false;
  bool stalled_ = false;
  bool voltage_mode_ = false;
  bool conducts_ = false;
};

}  // namespace stator::drive
