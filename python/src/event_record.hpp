// An event as Python sees it: stator._native.Event.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stator/rack/observe/event_log.hpp"

namespace stator::python {

/// Something that a device or a network had to say.
struct EventRecord {
  std::uint64_t number = 0;  ///< counted from 1 since the rack began
  double time = 0.0;         ///< s
  std::string severity;
  std::string id;
  std::string device;
  std::string text;
};

/// Those of `log` with a higher number than `after`, the oldest first.
[[nodiscard]] std::vector<EventRecord> events_of(const rack::EventLog& log, std::uint64_t after);

}  // namespace stator::python
