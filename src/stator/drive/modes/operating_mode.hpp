#pragma once

#include <cstdint>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/drive/motion/axis_motion.hpp"
#include "stator/drive/motion/axis_objects.hpp"
#include "stator/drive/motion/axis_settings.hpp"
#include "stator/drive/motion/position_capture.hpp"
#include "stator/drive/motion/position_feedback.hpp"

namespace stator::drive {

/// Codes of 6060h and 6061h (CiA 402-2 §8.5).
enum class ModeCode : std::int8_t {
  none = 0,
  profile_position = 1,
  profile_velocity = 3,
  profile_torque = 4,
  homing = 6,
  cyclic_synchronous_position = 8,
  cyclic_synchronous_velocity = 9,
  cyclic_synchronous_torque = 10,
};

/// What a mode works with. `enabled`: set-points are obeyed now (Operation enabled, no halt).
struct ModeContext {
  const AxisObjects& objects;
  const AxisSettings& settings;
  const AxisConditions& conditions;
  AxisMotion& motion;
  PositionFeedback& feedback;
  PositionCapture& capture;
  base::EventReporter reporter;
  std::uint8_t axis = 0;  ///< for events
  base::SimTime now;
  bool enabled = false;
  bool halted = false;
  bool ready = true;  ///< false: halted because the stage looks for its commutation
  bool following_error = false;
  bool closed_loop = false;  ///< the motor is commutated by its sensors
  /// Demand and actual position have one coordinate, as those of a servo axis.
  bool position_loop = false;
  double motor_current = 0.0;    ///< A, filtered, positive drives forward (servo axes)
  double actual_velocity = 0.0;  ///< pps

  /// 6064h in 64 bits: the encoder's position, or the demand where no encoder is used.
  [[nodiscard]] std::int64_t actual_position() const {
    return objects.uses_encoder() ? feedback.position() : motion.position();
  }
  /// How 605Dh lets halt stop the motor. 3 and 4, at the limits of current and voltage, stop the
  /// set-point at once: the loops give all they have.
  [[nodiscard]] Braking halt_braking() const {
    switch (objects.halt_option.get()) {
      case 2:
        return Braking::quick_stop_ramp;
      case 3:
      case 4:
        return Braking::at_once;
      default:
        return Braking::slow_down_ramp;
    }
  }
  /// The position to which the demand must go for the motor to stand where `captured` was held.
  [[nodiscard]] std::int64_t position_of(const CapturedPosition& captured) const {
    return position_loop ? feedback.position_at(captured.encoder_count)
                         : motion.position_of(captured.motor_microsteps);
  }
};

/// One mode of operation of an axis. Only the mode in force is called.
class OperatingMode {
 public:
  OperatingMode() = default;
  OperatingMode(const OperatingMode&) = delete;
  OperatingMode& operator=(const OperatingMode&) = delete;
  virtual ~OperatingMode() = default;

  [[nodiscard]] virtual ModeCode code() const = 0;
  /// The drive was enabled in this mode, or the mode chosen for an enabled drive.
  virtual void enter(const ModeContext& /*context*/) {}
  /// Set-points are obeyed from now on: follows enter(), at once or when halt ends.
  virtual void start(const ModeContext& /*context*/) {}
  /// Halt was commanded, or the stage is not ready.
  virtual void halt(const ModeContext& context) { context.motion.brake(context.halt_braking()); }
  /// Halt has been taken back.
  virtual void resume(const ModeContext& context) { start(context); }
  /// A controlword was written, also while the drive is not enabled.
  virtual void on_controlword(const ModeContext& /*context*/, std::uint16_t /*previous*/,
                              std::uint16_t /*present*/) {}
  /// A target or offset was written while set-points are obeyed.
  virtual void on_target(const ModeContext& /*context*/) {}
  /// Once per control period, after supervision.
  virtual void tick(const ModeContext& /*context*/) {}
  /// Bits 10, 12 and 13 of the statusword.
  [[nodiscard]] virtual std::uint16_t status(const ModeContext& /*context*/) const { return 0; }
};

/// Mode 0, and those whose behaviour the device does not have: the motor stands still.
class NoMode final : public OperatingMode {
 public:
  explicit NoMode(ModeCode code) : code_(code) {}
  [[nodiscard]] ModeCode code() const override { return code_; }

 private:
  ModeCode code_;
};

}  // namespace stator::drive
