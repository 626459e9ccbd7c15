#include "stator/control/motion_controller/stop_switches.hpp"

#include <utility>

namespace stator::control::motion_controller {

namespace {

/// A change to `now` that bit `going_active` or `going_inactive` of `mode` asks for.
bool event(bool before, bool now, std::uint32_t mode, std::uint32_t going_active,
           std::uint32_t going_inactive) {
  return before != now && (mode & (now ? going_active : going_inactive)) != 0;
}

}  // namespace

bool StopSwitches::sample(bool left_pin, bool right_pin) {
  const std::uint32_t mode = settings_.mode;
  bool left = left_pin == ((mode & switch_mode::kLeftActiveHigh) != 0);
  bool right = right_pin == ((mode & switch_mode::kRightActiveHigh) != 0);
  if ((mode & switch_mode::kSwap) != 0) {
    std::swap(left, right);
  }
  const bool of_left = sampled_ && event(left_, left, mode, switch_mode::kLatchLeftActive,
                                         switch_mode::kLatchLeftInactive);
  const bool of_right = sampled_ && event(right_, right, mode, switch_mode::kLatchRightActive,
                                          switch_mode::kLatchRightInactive);
  sampled_ = true;
  left_ = left;
  right_ = right;
  left_latched_ = left_latched_ || of_left;
  right_latched_ = right_latched_ || of_right;
  return of_left || of_right;
}

std::uint32_t StopSwitches::status() const {
  const StopConditions stop = stops();
  return (left_ ? 1U : 0U) | (right_ ? 2U : 0U) | (left_latched_ ? 4U : 0U) |
         (right_latched_ ? 8U : 0U) | (stop.left ? 16U : 0U) | (stop.right ? 32U : 0U);
}

std::uint32_t StopSwitches::read_status() {
  const std::uint32_t value = status();
  left_latched_ = false;
  right_latched_ = false;
  return value;
}

}  // namespace stator::control::motion_controller
