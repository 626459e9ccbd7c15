#pragma once

#include "drive/operating_mode.hpp"

namespace stator::drive {

/// Homing (CiA 402-2 §11) as far as it needs no motion: method 35, present position = home, which
/// works in every power state. With the other methods the motor stands still.
class Homing final : public OperatingMode {
 public:
  [[nodiscard]] ModeCode code() const override { return ModeCode::homing; }
  void on_controlword(const ModeContext& context, std::uint16_t previous,
                      std::uint16_t present) override;
  [[nodiscard]] std::uint16_t status(const ModeContext& context) const override;

 private:
  bool attained_ = false;
};

}  // namespace stator::drive
