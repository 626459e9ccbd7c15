#pragma once

#include "stator/base/led_pattern.hpp"
#include "stator/canopen/nmt_state.hpp"

namespace stator::canopen {

/// What the RUN LED of a node shows in an NMT state (CiA 303-3 §5.2): Stopped single flash,
/// Pre-operational blinking, Operational on; off during a reset.
[[nodiscard]] base::LedPattern run_led(NmtState state);

/// What a node knows of errors that its ERR LED tells.
struct ErrorIndication {
  bool bus_off = false;
  bool error_control_event = false;    ///< a guarding request or heartbeat is missing
  bool warning_limit_reached = false;  ///< by an error counter of the CAN controller
};

/// What the ERR LED shows (CiA 303-3 §5.1): on when bus-off, double flash for an event of error
/// control, single flash when the warning limit is reached. Of several the first in that order
/// shows.
[[nodiscard]] base::LedPattern error_led(const ErrorIndication& indication);

}  // namespace stator::canopen
