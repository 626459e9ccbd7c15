#pragma once

#include "stator/drive/modes/operating_mode.hpp"

namespace stator::drive {

/// Profile position (CiA 402-2 §10). A rising edge of controlword bit 4 takes 607Ah over at once,
/// also while the motor travels; there is no queue (bits 5 and 9 are not supported).
class ProfilePosition final : public OperatingMode {
 public:
  [[nodiscard]] ModeCode code() const override { return ModeCode::profile_position; }
  void enter(const ModeContext& context) override;
  void halt(const ModeContext& context) override;
  void resume(const ModeContext& context) override;
  void on_controlword(const ModeContext& context, std::uint16_t previous,
                      std::uint16_t present) override;
  void tick(const ModeContext& context) override;
  [[nodiscard]] std::uint16_t status(const ModeContext& context) const override;

 private:
  void travel(const ModeContext& context);
  [[nodiscard]] std::int64_t new_target(const ModeContext& context, bool relative) const;
  [[nodiscard]] bool within_window(const ModeContext& context) const;
  [[nodiscard]] bool target_reached(const ModeContext& context) const;

  std::int64_t target_ = 0;    ///< in force, microsteps
  double direction_ = 0.0;     ///< to it, as seen from where the travel began; 0: not yet
  bool went_on_ = false;       ///< halted behind it, on the end velocity
  bool commanded_ = false;     ///< a set-point has come since enter()
  bool acknowledged_ = false;  ///< statusword bit 12
  bool in_window_ = false;
  base::SimTime window_entered_;
};

/// Profile velocity (CiA 402-2 §16): 60FFh with 6083h and 6084h. Target reached and speed 0 are
/// what AxisSettings calls so.
class ProfileVelocity final : public OperatingMode {
 public:
  [[nodiscard]] ModeCode code() const override { return ModeCode::profile_velocity; }
  void start(const ModeContext& context) override { on_target(context); }
  void on_target(const ModeContext& context) override;
  void tick(const ModeContext& context) override;
  [[nodiscard]] std::uint16_t status(const ModeContext& context) const override;

 private:
  [[nodiscard]] bool within_window(const ModeContext& context) const;

  bool in_window_ = false;
  base::SimTime window_entered_;
  bool above_threshold_ = false;
  base::SimTime threshold_passed_;
  bool turns_ = false;  ///< above the threshold for long enough
};

}  // namespace stator::drive
