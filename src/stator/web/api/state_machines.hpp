#pragma once

#include "stator/web/message.hpp"

namespace stator::web {

/// The graphs of the state machines that panels name: states and transitions, as the tables have
/// them by which devices work.
[[nodiscard]] Response describe_state_machines();

}  // namespace stator::web
