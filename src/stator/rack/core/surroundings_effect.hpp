#pragma once

#include <memory>

#include "stator/rack/core/fault_effects.hpp"
#include "stator/rack/faults/fault_configuration.hpp"

namespace stator::rack {

/// What a fault of FaultAction::surroundings does to a rack, see settings_of().
[[nodiscard]] std::unique_ptr<FaultEffect> make_surroundings_effect(
    Rack& rack, const FaultConfiguration& fault);

}  // namespace stator::rack
