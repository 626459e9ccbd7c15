#pragma once

#include <limits>

namespace stator::control {

/// Switches the resistor across the supply: on above the limit, off below limit minus hysteresis
/// (TMCC160 2090h, A-49).
class BrakeChopper {
 public:
  /// Volt. Not enabled means off.
  void configure(bool enabled, double limit, double hysteresis) {
    on_above_ = enabled ? limit : std::numeric_limits<double>::infinity();
    off_below_ = enabled ? limit - hysteresis : std::numeric_limits<double>::infinity();
  }
  bool step(double supply_voltage) {
    on_ = supply_voltage > on_above_ || (on_ && supply_voltage >= off_below_);
    return on_;
  }
  [[nodiscard]] bool on() const { return on_; }

 private:
  double on_above_ = std::numeric_limits<double>::infinity();
  double off_below_ = std::numeric_limits<double>::infinity();
  bool on_ = false;
};

}  // namespace stator::control
