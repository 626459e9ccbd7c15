#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "stator/rack/faults/fault_configuration.hpp"

namespace stator::rack {

/// An input that faults of a kind can set.
struct ReachedInput {
  std::string name;  ///< without its owner's: of an axis, a peripheral, or the device
  /// Of a peripheral on a board, which the key "peripheral" has to name in addition.
  bool of_peripheral = false;
  /// With what a fault sets it first, of those keys that decide which inputs it sets.
  std::vector<std::pair<std::string_view, FaultValue>> keys;
};

/// All inputs that faults of a kind can set at an axis, a peripheral or a device of some product,
/// with the keys for it, as settings_of() tells; empty: the kind sets none.
[[nodiscard]] std::vector<ReachedInput> inputs_reached_by(const FaultKind& kind);

}  // namespace stator::rack
