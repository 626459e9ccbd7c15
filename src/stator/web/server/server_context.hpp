#pragma once

#include "stator/web/server/guard.hpp"
#include "stator/web/server/idle_connections.hpp"
#include "stator/web/server/server_limits.hpp"
#include "stator/web/state.hpp"
#include "stator/web/stream/rack_access.hpp"
#include "stator/web/stream/traffic_hub.hpp"

namespace stator::web {

/// What the connections of a server share; all in its thread.
struct ServerContext {
  ServerLimits limits;
  Guard guard;
  State state;
  RackAccess access;
  TrafficHub traffic;
  IdleConnections idle{};
};

}  // namespace stator::web
