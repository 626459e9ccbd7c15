#pragma once

#include <string>

#include "stator/base/delegate.hpp"

namespace stator::base {

/// A named, unit-carrying value that can be recorded or plotted, e.g. "axis0.position_actual" in
/// "microstep".
struct Signal {
  std::string name;
  std::string unit;
  Delegate<double()> read;
};

}  // namespace stator::base
