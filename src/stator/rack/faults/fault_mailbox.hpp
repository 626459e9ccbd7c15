#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/base/delegate.hpp"
#include "stator/base/recurrence.hpp"
#include "stator/ethercat/stack/mailbox_intervention.hpp"
#include "stator/rack/faults/fault_configuration.hpp"

namespace stator::rack {

/// A fault of a slave's mailbox.
struct MailboxFault {
  enum class Kind : std::uint8_t {
    silent,  ///< requests are not answered
    full,    ///< requests are not taken
    abort,   ///< SDO requests are aborted
  };
  Kind kind = Kind::silent;
  std::uint64_t count = 0;  ///< requests; 0: until it is withdrawn
  double probability = 1.0;
  std::uint64_t seed = 1;
  std::uint32_t code = 0;               ///< of `abort`
  std::optional<FaultObject> object{};  ///< of `abort`: only of this
};
[[nodiscard]] MailboxFault mailbox_stall(const FaultConfiguration& fault);
[[nodiscard]] MailboxFault mailbox_abort(const FaultConfiguration& fault);

/// A request as whoever waits for one sees it.
struct MailboxStep {
  std::optional<FaultObject> object{};  ///< of an SDO; of a segment that of its transfer
  unsigned segment = 0;                 ///< number of the segment within its transfer, from 1
  base::SimTime time;
};

/// The faults of one slave's mailbox. Tells whoever waits of each request before it is handled, so
/// that a fault that begins then hits that request.
class MailboxFaults final : public ethercat::MailboxIntervention {
 public:
  using Listener = base::Delegate<void(const MailboxFaults&, const MailboxStep&)>;
  explicit MailboxFaults(Listener listener) : listener_(listener) {}

  std::uint64_t inject(const MailboxFault& fault);
  void withdraw(std::uint64_t number);
  [[nodiscard]] std::optional<std::uint64_t> hits(std::uint64_t number) const;

  [[nodiscard]] bool takes_requests() override;
  [[nodiscard]] bool handles(const ethercat::MailboxHeader& header,
                             std::span<const std::byte> request, base::SimTime now) override;
  [[nodiscard]] std::optional<std::uint32_t> aborts_sdo(std::uint16_t index,
                                                        std::uint8_t subindex) override;

 private:
  struct Fault {
    std::uint64_t number = 0;
    MailboxFault fault;
    base::Recurrence recurrence;
  };
  void follow(const ethercat::MailboxHeader& header, std::span<const std::byte> request,
              base::SimTime now);

  Listener listener_;
  std::vector<Fault> faults_;
  std::uint64_t newest_ = 0;
  std::optional<FaultObject> transfer_{};  ///< of the newest initiate request
  unsigned segments_ = 0;                  ///< of that transfer so far
};

}  // namespace stator::rack
