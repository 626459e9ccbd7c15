#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "stator/base/sim_time.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/rack/faults/fault_configuration.hpp"
#include "stator/rack/world/held.hpp"

namespace stator::rack {

class MailboxFaults;
class Rack;

/// What a fault does to a rack, from its begin to its end. Begin and end come once each, in a
/// moment to which the rack has been brought.
class FaultEffect {
 public:
  FaultEffect() = default;
  FaultEffect(const FaultEffect&) = delete;
  FaultEffect& operator=(const FaultEffect&) = delete;
  virtual ~FaultEffect() = default;

  virtual void begin(base::SimTime now) = 0;
  virtual void end(base::SimTime now) = 0;
  /// How often it has hit; nothing: as often as it should. For those that count.
  [[nodiscard]] virtual std::optional<std::uint64_t> hits() const { return 0; }
  /// When it does something else in between, by step().
  [[nodiscard]] virtual base::SimTime next_step() const { return base::SimTime::never(); }
  virtual void step(base::SimTime /*now*/) {}
};

/// What faults hold of slaves beside what a rack can set: see Held. Outlives their effects.
struct HeldInSlaves {
  /// What steps up are refused with.
  std::map<DeviceAddress, Held<ethercat::AlStatusCode>> refusals;
  /// Bits of the EEPROM that read wrong, by the offset of their byte.
  std::map<std::pair<DeviceAddress, std::int64_t>, Held<std::uint8_t>> sii_bits;
};

/// The effect of a fault on `rack`; `mailbox` is where faults of the target's mailbox live, null
/// for other actions. Throws std::runtime_error for what `rack` does not have.
[[nodiscard]] std::unique_ptr<FaultEffect> make_fault_effect(Rack& rack,
                                                             const FaultConfiguration& fault,
                                                             MailboxFaults* mailbox,
                                                             HeldInSlaves& held);

}  // namespace stator::rack
