#pragma once

#include <string>

#include "base/delegate.hpp"

namespace stator::devices {

/// A named, unit-carrying value of a device that can be recorded or plotted,
/// e.g. "axis0.position_actual" in "microstep".
struct Signal {
  std::string name;
  std::string unit;
  base::Delegate<double()> read;
};

}  // namespace stator::devices
