#pragma once

#include "stator/web/message.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

/// Tells how masters and other programs reach each link of the rack.
[[nodiscard]] Response describe_connections(const State& state);

}  // namespace stator::web
