#pragma once

#include <cstdint>
#include <vector>

#include "stator/base/axis_signals.hpp"
#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/control/motion_controller/motion_controller.hpp"
#include "stator/control/motion_controller/reference_search.hpp"
#include "stator/devices/tmcm_142/driver_stage.hpp"
#include "stator/devices/tmcm_142/options.hpp"
#include "stator/plant/axes/stepper_axis.hpp"
#include "stator/plant/axes/stepper_axis_instruments.hpp"
#include "stator/product/device/input.hpp"
#include "stator/product/device/signal.hpp"

namespace stator::devices::tmcm_142 {

/// What the axis knows of its module in a period.
struct AxisConditions {
  bool powered = true;
  bool shut_down = false;                ///< the shutdown pin is active
  bool step_direction_connected = true;  ///< pins 8 and 10 are not RS-232's (L262-L265)
};

/// What has happened in a period, each told once, and anew for each motion command that it ends.
struct AxisEvents {
  bool driver_error = false;
  bool shut_down = false;
  bool deviation = false;
  bool position_error = false;  ///< a limit was hit, or a reference search failed (A80)
};

/// Power stage settings among the axis parameters.
struct StageSettings {
  bool mixed_decay_run = true;
  bool mixed_decay_standby = true;
  std::int32_t chopper_divider = 444;

  friend bool operator==(const StageSettings&, const StageSettings&) = default;
};

/// The one axis of the module: motion controller, reference search, power stage, and the world
/// behind its connectors. Passive: step() lets one control period pass.
///
/// Limit switches and home switch are optically isolated and active low (L262-L276): a closed
/// contact draws current through its input, whose pin is low then. So a plant::PositionSwitch that
/// is pressed ("signal high") is a closed contact and a low pin.
class MotionAxis {
 public:
  using Controller = control::motion_controller::MotionController;

  MotionAxis(const plant::StepperAxisParameters& plant, base::EventReporter reporter);
  MotionAxis(const MotionAxis&) = delete;
  MotionAxis& operator=(const MotionAxis&) = delete;
  ~MotionAxis() = default;

  /// Motion controller and stage begin anew; motor and load go on.
  void restart();
  AxisEvents step(base::SimTime now, base::SimDuration period, const AxisConditions& conditions);

  // Motion; a reference search under way ends. While the power stage is off, by the shutdown pin or
  // an error, the motor stands and a motion command ends with the next period: parameter 0 keeps
  // its target, and nothing begins when the stage works again.

  void move_to(std::int32_t position);
  /// Units of the chip.
  void rotate(std::int32_t velocity);
  void set_target_velocity(std::int32_t velocity);
  void set_mode(control::motion_controller::Mode mode);

  void start_search(const control::motion_controller::SearchSettings& settings);
  void stop_search();
  [[nodiscard]] const control::motion_controller::ReferenceSearch& search() const {
    return search_;
  }

  /// Everything else that axis parameters show and set.
  [[nodiscard]] Controller& controller() { return controller_; }
  [[nodiscard]] const Controller& controller() const { return controller_; }
  void set_stage(const StageSettings& settings) { stage_settings_ = settings; }
  [[nodiscard]] const DriverStage& stage() const { return stage_; }
  /// Parameter 48: the position whose passing is an event of the simulation (A40).
  void arm_compare(std::int32_t position);

  [[nodiscard]] plant::StepperAxis& plant() { return plant_; }
  [[nodiscard]] const plant::StepperAxis& plant() const { return plant_; }
  /// The contact of the home switch is closed.
  [[nodiscard]] bool home_contact() const { return plant_.sensing().home_switch; }

  /// "axis0.<name>".
  void append_signals(std::vector<product::Signal>& signals) const;
  void append_inputs(std::vector<product::Input>& inputs) {
    instruments_.append_inputs(inputs, "axis0.");
  }

 private:
  [[nodiscard]] double position() const { return controller_.position(); }
  [[nodiscard]] double target_position() const { return controller_.target_position(); }
  [[nodiscard]] double velocity() const;
  [[nodiscard]] double target_velocity() const;
  [[nodiscard]] double encoder_position() const { return controller_.encoder_position(); }
  [[nodiscard]] double encoder_count() const {
    return static_cast<double>(plant_.sensing().encoder_count);
  }
  [[nodiscard]] double ramp_mode() const { return static_cast<double>(controller_.mode()); }
  [[nodiscard]] double search_state() const { return static_cast<double>(search_.state()); }
  [[nodiscard]] double status_flags() const { return controller_.status_flags(); }
  [[nodiscard]] double left_switch() const { return controller_.left_switch() ? 1.0 : 0.0; }
  [[nodiscard]] double right_switch() const { return controller_.right_switch() ? 1.0 : 0.0; }
  [[nodiscard]] double current_scale() const { return controller_.current_scale(); }
  [[nodiscard]] double load_value() const { return stage_.load_value(); }
  [[nodiscard]] double driver_error() const { return stage_.error() ? 1.0 : 0.0; }
  [[nodiscard]] double step_pulses() const { return static_cast<double>(shown_pulses_); }
  [[nodiscard]] double step_forward() const {
    return controller_.step_direction().forward ? 1.0 : 0.0;
  }
  [[nodiscard]] double full_step_pulses() const {
    return static_cast<double>(controller_.full_step_pulses());
  }

  void begin_motion();
  void stand_undriven(base::SimTime now, AxisEvents& events);
  void look_for_events(base::SimTime now, AxisEvents& events);
  void report_compare(base::SimTime now);
  [[nodiscard]] bool at_limit() const;

  base::EventReporter reporter_;
  plant::StepperAxis plant_;
  plant::StepperAxisInstruments instruments_;
  Controller controller_;
  control::motion_controller::ReferenceSearch search_;
  DriverStage stage_;
  StageSettings stage_settings_;

  // As seen in the period before.
  bool driver_error_ = false;
  bool deviation_ = false;
  bool search_failed_ = false;
  bool at_limit_ = false;
  bool shut_down_ = false;
  bool undriven_ = false;
  bool undriven_told_ = false;  ///< that this kept the motor from moving
  bool bow_too_large_ = false;
  bool compare_armed_ = false;
  bool compare_ahead_ = false;  ///< the position lies to the right
  std::int32_t compare_position_ = 0;
  std::int64_t seen_pulses_ = 0;   ///< of the controller
  std::int64_t shown_pulses_ = 0;  ///< on pin 8
};

}  // namespace stator::devices::tmcm_142
