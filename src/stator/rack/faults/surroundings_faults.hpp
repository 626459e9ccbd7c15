#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stator/product/device/input.hpp"
#include "stator/rack/faults/fault_configuration.hpp"

namespace stator::rack {

/// An input that a fault of motor, load, sensors or supply sets.
struct FaultSetting {
  std::string input;
  double value = 0.0;
  std::string_view key;  ///< of the fault, that the value comes from
  /// The value is reached within the fault's `over`, if it has one.
  bool ramped = false;
};

/// Kinds of faults of everything around a device by the names people
/// have for them. Each sets inputs, all of which are sound at 0.
[[nodiscard]] std::span<const FaultKind> surroundings_fault_kinds();

/// The inputs that such a fault holds from its begin on, in this order; at its end they are
/// released in reverse order, see overridable.hpp. `inputs` are those of the device: names differ
/// between products; nothing: all names that an input has with some product.
[[nodiscard]] std::vector<FaultSetting> settings_of(
    const FaultConfiguration& fault, std::optional<std::span<const product::InputRange>> inputs);

}  // namespace stator::rack
