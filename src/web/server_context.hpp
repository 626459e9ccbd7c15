#pragma once

#include "web/guard.hpp"
#include "web/rack_access.hpp"
#include "web/server_limits.hpp"
#include "web/state.hpp"

namespace stator::web {

/// What the connections of a server share; all in its thread.
struct ServerContext {
  ServerLimits limits;
  Guard guard;
  State state;
  RackAccess access;
};

}  // namespace stator::web
