#pragma once

#include <cstdint>

#include "stator/base/event_text.hpp"

namespace stator::canopen {

/// States of the NMT slave state machine with the codes that heartbeat and node guarding report
/// (CiA 301 §7.3.2.2).
enum class NmtState : std::uint8_t {
  initialisation = 0,
  stopped = 4,
  operational = 5,
  pre_operational = 127,
};

/// The standard's name, e.g. "Pre-operational". The text is of static lifetime and ends with 0.
[[nodiscard]] base::StaticText to_text(NmtState state);

}  // namespace stator::canopen
