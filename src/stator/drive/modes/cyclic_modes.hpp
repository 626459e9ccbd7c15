#pragma once

#include "stator/drive/modes/operating_mode.hpp"

namespace stator::drive {

/// Cyclic synchronous position (CiA 402-2 §13): 607Ah + 60B0h, reached within 60C2h; no ramps but
/// to catch up what was held back. Statusword bit 12: the target is followed, nothing holds back.
/// 60B1h and 60B2h are feed-forward where ProfileBehaviour says so.
class CyclicPosition final : public OperatingMode {
 public:
  [[nodiscard]] ModeCode code() const override { return ModeCode::cyclic_synchronous_position; }
  void start(const ModeContext& context) override { on_target(context); }
  void on_target(const ModeContext& context) override;
  [[nodiscard]] std::uint16_t status(const ModeContext& context) const override;
};

/// Cyclic synchronous velocity (CiA 402-2 §14): 60FFh + 60B1h, reached within 60C2h; no ramps but
/// to catch up what was held back. Statusword bit 12 as in cyclic synchronous position. 60B2h is
/// feed-forward where ProfileBehaviour says so.
class CyclicVelocity final : public OperatingMode {
 public:
  [[nodiscard]] ModeCode code() const override { return ModeCode::cyclic_synchronous_velocity; }
  void start(const ModeContext& context) override { on_target(context); }
  void on_target(const ModeContext& context) override;
  [[nodiscard]] std::uint16_t status(const ModeContext& context) const override;
};

}  // namespace stator::drive
