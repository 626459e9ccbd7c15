#pragma once

#include <cstdint>

namespace stator::ethercat {

/// Counters since construction or reset(), for people and tests.
struct SlaveStackStatistics {
  std::uint64_t state_changes = 0;
  std::uint64_t refused_state_changes = 0;
  std::uint64_t mailbox_received = 0;
  std::uint64_t mailbox_sent = 0;
  std::uint64_t mailbox_duplicates = 0;
  std::uint64_t mailbox_repeats = 0;
  std::uint64_t mailbox_errors = 0;
  std::uint64_t sdo_aborts = 0;
  std::uint64_t emergencies_sent = 0;
  std::uint64_t emergencies_dropped = 0;
  std::uint64_t outputs_received = 0;
  std::uint64_t outputs_refused = 0;
  std::uint64_t inputs_published = 0;
  std::uint64_t watchdog_expirations = 0;
};

}  // namespace stator::ethercat
