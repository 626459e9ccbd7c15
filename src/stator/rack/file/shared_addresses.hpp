#pragma once

#include <string>
#include <vector>

#include "stator/rack/core/rack_configuration.hpp"

namespace stator::rack {

/// One sentence for each address that devices of one network share as they are delivered: node-IDs
/// and CAN identifiers of modules on a bus, addresses of modules on a serial line. A rack may have
/// that, to rehearse it; mostly somebody forgot a key.
[[nodiscard]] std::vector<std::string> shared_addresses(const RackConfiguration& configuration);

}  // namespace stator::rack
