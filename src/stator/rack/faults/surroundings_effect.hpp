#pragma once

#include "stator/rack/faults/fault_effects.hpp"

namespace stator::rack {

/// What a fault of the surroundings does, see settings_of().
[[nodiscard]] MadeEffect surroundings_effect(const FaultSite& site,
                                             const FaultConfiguration& fault);

}  // namespace stator::rack
