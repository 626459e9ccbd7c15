#pragma once

#include <string>

#include "stator/base/delegate.hpp"

namespace stator::base {

/// Something of the world around a device that a person, a timetable or a test may set while it
/// runs, e.g. "axis0.load_torque" in "Nm" or "axis1.home_switch" (0 or 1). The counterpart of
/// Signal. Values are finite and lie in minimum..maximum; who sets one checks that.
struct Input {
  std::string name;  ///< unique within the device
  std::string unit;
  double minimum = 0.0;
  double maximum = 1.0;
  Delegate<void(double)> set;
};

}  // namespace stator::base
