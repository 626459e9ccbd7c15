#pragma once

#include <memory>

#include "rack/fault_configuration.hpp"
#include "rack/fault_effects.hpp"

namespace stator::rack {

/// What a fault of FaultAction::surroundings does to a rack, see settings_of().
[[nodiscard]] std::unique_ptr<FaultEffect> make_surroundings_effect(
    Rack& rack, const FaultConfiguration& fault);

}  // namespace stator::rack
