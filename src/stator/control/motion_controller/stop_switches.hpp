#pragma once

#include <cstdint>

#include "stator/control/motion_controller/motion_controller_ramp.hpp"
#include "stator/control/motion_controller/motion_controller_settings.hpp"

namespace stator::control::motion_controller {

/// The two stop switch inputs: polarity, swap, stop conditions, and the events that latch
/// positions. Polarity belongs to a pin and is applied before the swap (A44).
class StopSwitches {
 public:
  void configure(const SwitchSettings& settings) { settings_ = settings; }

  /// Takes in the levels of REF_L and REF_R (true = high). True if an event of AP 14 bits 8..11
  /// has come since the call before; the first call sees none.
  bool sample(bool left_pin, bool right_pin);

  [[nodiscard]] bool left() const { return left_; }    ///< AP 11
  [[nodiscard]] bool right() const { return right_; }  ///< AP 10
  [[nodiscard]] StopConditions stops() const {
    return {.left = left_ && !settings_.left_disabled,
            .right = right_ && !settings_.right_disabled};
  }
  [[nodiscard]] bool latches_encoder() const {
    return (settings_.mode & switch_mode::kLatchEncoder) != 0;
  }

  /// AP 9 (A42): bits 0/1 left, right active; 2/3 latch event of left, right; 4/5 stop conditions.
  [[nodiscard]] std::uint32_t status() const;
  /// The same, and clears bits 2 and 3.
  std::uint32_t read_status();

 private:
  SwitchSettings settings_;
  bool sampled_ = false;
  bool left_ = false;
  bool right_ = false;
  bool left_latched_ = false;
  bool right_latched_ = false;
};

}  // namespace stator::control::motion_controller
