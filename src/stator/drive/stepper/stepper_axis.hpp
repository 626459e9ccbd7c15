#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "stator/base/axis_signals.hpp"
#include "stator/drive/axis/axis.hpp"
#include "stator/drive/stepper/closed_loop_conditions.hpp"
#include "stator/drive/stepper/driver_chip.hpp"
#include "stator/drive/stepper/stepper_settings.hpp"
#include "stator/drive/stepper/stepper_stage.hpp"

namespace stator::drive {

/// A CiA 402 axis with a stepper motor: sequencer and driver chip, in open loop or commutated by an
/// encoder. See Axis for the calls.
class StepperAxis final : public Axis {
 public:
  /// Binds the axis to its objects. Throws std::logic_error if one is missing.
  StepperAxis(dictionary::Dictionary& dictionary, const AxisConfiguration& configuration,
              base::EventReporter reporter);

  /// To be brought up to date before apply() and tick(), with settings().
  [[nodiscard]] StepperSettings& stepper_settings() { return stepper_settings_; }
  [[nodiscard]] const StepperSettings& stepper_settings() const { return stepper_settings_; }

  /// Lets `duration` pass for ramp and driver; `sensing` is what the sensors told at its begin.
  base::AxisActuation step(base::SimDuration duration, const base::AxisSensing& sensing);

  /// Waits for the next index pulse of the encoder (not before 606Ah selects one), or no longer.
  void arm_index_latch(bool armed);
  struct LatchedPositions {
    std::int64_t demand = 0;   ///< 6062h at the index pulse, microsteps
    std::int64_t encoder = 0;  ///< 6064h by the encoder there, microsteps
  };
  /// What the latch holds, once.
  [[nodiscard]] std::optional<LatchedPositions> take_index_latch();

  [[nodiscard]] const DriverChip& driver() const { return driver_; }
  [[nodiscard]] double actual_velocity() const override;
  [[nodiscard]] std::uint64_t step_count() const { return stage_.step_count(); }
  [[nodiscard]] const control::ClosedLoopController& closed_loop() const {
    return stage_.closed_loop();
  }
  void set_commutation_offset(std::int32_t offset) { stage_.set_commutation_offset(offset); }

 private:
  void begin_period(base::SimTime now) override;
  void supervise_stage(base::SimTime now) override;
  [[nodiscard]] StageStatus stage_status() const override;
  void fault_was_reset() override { driver_.clear_shorts(); }
  [[nodiscard]] double torque_current() const override;
  [[nodiscard]] bool voltage_enabled() const override;
  [[nodiscard]] double shown_velocity() const override { return motion_.velocity(); }

  void supervise_closed_loop(base::SimTime now);
  void follow_rotor();
  void update_feedback();
  void capture_positions(const base::AxisSensing& sensing);
  void stop_on_stall();

  StepperSettings stepper_settings_;
  StepperStage stage_;
  DriverChip driver_;
  PositionCapture index_latch_;
  ClosedLoopConditions closed_loop_conditions_;
  bool closed_loop_wanted_ = false;  ///< and possible
  std::int64_t encoder_count_ = 0;
  std::array<double, 2> coil_current_{};
};

}  // namespace stator::drive
