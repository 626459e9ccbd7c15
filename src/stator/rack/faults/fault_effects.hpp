#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "stator/base/delegate.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/can/error_counters.hpp"
#include "stator/can/frame_faults.hpp"
#include "stator/ethercat/segment/frame_faults.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/rack/faults/fault_configuration.hpp"
#include "stator/rack/faults/target.hpp"
#include "stator/rack/networks/serial_faults.hpp"
#include "stator/rack/world/overridable.hpp"

namespace stator::rack {

class MailboxFaults;

/// What a fault does to its target, from its begin to its end. Begin and end come once each, in a
/// moment to which the target has been brought.
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

/// What faults hold of slaves beside what events can set: see Overridable. Outlives their effects.
struct SlaveOverrides {
  /// What steps up are refused with.
  std::map<DeviceAddress, Overridable<ethercat::AlStatusCode>> refusals;
  /// Bits of the EEPROM that read wrong, by the offset of their byte.
  std::map<std::pair<DeviceAddress, std::int64_t>, Overridable<std::uint8_t>> sii_bits;
};

/// Where the effect of a fault is made.
struct FaultSite {
  faults::Target& target;
  SlaveOverrides& held;
  /// The faults of a slave's mailbox. Throws std::runtime_error for a device without one.
  base::Delegate<MailboxFaults&(DeviceAddress)> mailbox;
};

// What each kind of fault does, see FaultKind::make. They throw std::runtime_error for what the
// target does not have.

using MadeEffect = std::unique_ptr<FaultEffect>;

[[nodiscard]] MadeEffect ethercat_frame_effect(const FaultSite& site,
                                               const FaultConfiguration& fault,
                                               ethercat::FrameFaultKind kind);
[[nodiscard]] MadeEffect can_frame_effect(const FaultSite& site, const FaultConfiguration& fault,
                                          can::FrameFaultKind kind);
[[nodiscard]] MadeEffect can_state_effect(const FaultSite& site, const FaultConfiguration& fault,
                                          can::ErrorState state);
[[nodiscard]] MadeEffect serial_effect(const FaultSite& site, const FaultConfiguration& fault,
                                       SerialFaultKind kind);
[[nodiscard]] MadeEffect link_effect(const FaultSite& site, const FaultConfiguration& fault);
[[nodiscard]] MadeEffect power_effect(const FaultSite& site, const FaultConfiguration& fault);
[[nodiscard]] MadeEffect mailbox_stall_effect(const FaultSite& site,
                                              const FaultConfiguration& fault);
[[nodiscard]] MadeEffect mailbox_abort_effect(const FaultSite& site,
                                              const FaultConfiguration& fault);
[[nodiscard]] MadeEffect al_error_effect(const FaultSite& site, const FaultConfiguration& fault);
[[nodiscard]] MadeEffect fall_back_effect(const FaultSite& site, const FaultConfiguration& fault);
[[nodiscard]] MadeEffect working_counter_effect(const FaultSite& site,
                                                const FaultConfiguration& fault);
[[nodiscard]] MadeEffect sii_effect(const FaultSite& site, const FaultConfiguration& fault);
[[nodiscard]] MadeEffect clock_drift_effect(const FaultSite& site, const FaultConfiguration& fault);
[[nodiscard]] MadeEffect input_effect(const FaultSite& site, const FaultConfiguration& fault);

}  // namespace stator::rack
