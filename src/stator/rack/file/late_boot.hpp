#pragma once

#include "stator/rack/core/rack_configuration.hpp"

namespace stator::rack {

/// Delays the power of devices with the quirk late-boot: they have none from the rack's start on
/// until their time is over, and get it as much later at each event that switches it on.
void apply_late_boot(RackConfiguration& configuration);

}  // namespace stator::rack
