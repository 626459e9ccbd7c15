#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "stator/base/sim_time.hpp"
#include "stator/ethercat/standard/mailbox_protocol.hpp"

namespace stator::ethercat {

/// Sees the requests that come to a slave's mailbox and may spoil their handling, as a firmware
/// does that hangs or refuses.
class MailboxIntervention {
 public:
  MailboxIntervention() = default;
  MailboxIntervention(const MailboxIntervention&) = delete;
  MailboxIntervention& operator=(const MailboxIntervention&) = delete;
  virtual ~MailboxIntervention() = default;

  /// False: the firmware does not look at its mailbox, a request stays in SM0.
  [[nodiscard]] virtual bool takes_requests() = 0;
  /// A request was taken, without its mailbox header. False: nobody handles or answers it.
  [[nodiscard]] virtual bool handles(const MailboxHeader& header,
                                     std::span<const std::byte> request, base::SimTime now) = 0;
  /// The abort code with which an SDO request for that entry is refused; nothing: it is handled.
  [[nodiscard]] virtual std::optional<std::uint32_t> aborts_sdo(std::uint16_t index,
                                                                std::uint8_t subindex) = 0;
};

}  // namespace stator::ethercat
