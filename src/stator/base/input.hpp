#pragma once

#include <string>
#include <utility>

#include "stator/base/delegate.hpp"

namespace stator::base {

/// Something of the world around a device that a person, a timetable or a test may set while it
/// runs, e.g. "axis0.load_torque" in "Nm" or "axis1.home_switch" (0 or 1). The counterpart of
/// Signal. Values are finite and lie in minimum..maximum; who sets one checks that.
struct InputRange {
  std::string name;  ///< unique within the device
  std::string unit;
  double minimum = 0.0;
  double maximum = 1.0;
};

/// The same with the way to set it, for whoever stands for the world around the device.
struct Input : InputRange {
  Input() = default;
  Input(std::string name_of_it, std::string unit_of_it, double lowest, double highest,
        Delegate<void(double)> setter)
      : set(setter) {
    name = std::move(name_of_it);
    unit = std::move(unit_of_it);
    minimum = lowest;
    maximum = highest;
  }

  Delegate<void(double)> set;
};

}  // namespace stator::base
