#pragma once

#include "stator/drive/modes/operating_mode.hpp"

namespace stator::drive {

/// Cyclic synchronous torque (CiA 402-2 §15): 6071h + 60B2h, in AxisSettings::torque_unit, is the
/// current that makes torque: of a stepper the phase current at the largest load angle, of a servo
/// motor that of the q axis; its sign is the direction. A new value is reached within 60C2h. Needs
/// closed loop; without it the target is ignored and the motor stands still.
class CyclicTorque final : public OperatingMode {
 public:
  [[nodiscard]] ModeCode code() const override { return ModeCode::cyclic_synchronous_torque; }
  void start(const ModeContext& context) override;
  void on_target(const ModeContext& context) override;
  void tick(const ModeContext& context) override;
  void halt(const ModeContext& context) override;
  [[nodiscard]] std::uint16_t status(const ModeContext& context) const override;

 private:
  [[nodiscard]] double interpolated(base::SimTime now) const;

  double from_ = 0.0;    ///< A
  double target_ = 0.0;  ///< A
  base::SimTime since_;
  base::SimDuration period_;
};

/// Profile torque (CiA 402-2 §17): 6071h, approached with 6087h from 0; a slope of 0 takes it over
/// at once. Statusword bit 10: the demand is on the target, of a halted drive: the motor stands.
/// Needs closed loop, as cst.
class ProfileTorque final : public OperatingMode {
 public:
  [[nodiscard]] ModeCode code() const override { return ModeCode::profile_torque; }
  void start(const ModeContext& context) override;
  void tick(const ModeContext& context) override;
  [[nodiscard]] std::uint16_t status(const ModeContext& context) const override;

 private:
  [[nodiscard]] double target(const ModeContext& context) const;

  double demand_ = 0.0;  ///< A
  base::SimTime since_;  ///< when it became that
};

}  // namespace stator::drive
