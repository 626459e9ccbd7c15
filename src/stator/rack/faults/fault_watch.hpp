#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/can/bus.hpp"
#include "stator/ethercat/segment/frame_faults.hpp"
#include "stator/product/device/signal.hpp"
#include "stator/rack/faults/fault_configuration.hpp"
#include "stator/rack/faults/fault_mailbox.hpp"
#include "stator/rack/faults/target.hpp"
#include "stator/rack/world/clock.hpp"

namespace stator::rack {

/// Waits for a milestone on behalf of one fault.
class FaultWatch {
 public:
  FaultWatch() = default;
  FaultWatch(const FaultWatch&) = delete;
  FaultWatch& operator=(const FaultWatch&) = delete;
  virtual ~FaultWatch() = default;

  /// True when the milestone has been reached.
  [[nodiscard]] virtual bool reached() = 0;
  /// A request came to the mailbox of the device that is watched.
  virtual void see(const MailboxStep& /*step*/) {}
};

/// Makes watches and lets them see what passes on the networks of a target, of those only that
/// somebody watches.
class FaultWatches {
 public:
  /// `target` must outlive the watches.
  explicit FaultWatches(faults::Target& target);
  FaultWatches(const FaultWatches&) = delete;
  FaultWatches& operator=(const FaultWatches&) = delete;
  ~FaultWatches();

  /// Throws std::runtime_error for a signal the device has not. The watch must not outlive this.
  [[nodiscard]] std::unique_ptr<FaultWatch> make(const Milestone& milestone);
  /// No watch is left: nobody need look at what passes.
  void rest();

 private:
  class SegmentTap;
  class BusTap;
  class CycleWatch;
  class FrameWatch;

  faults::Target& target_;
  std::map<std::size_t, std::unique_ptr<SegmentTap>> segments_;
  std::map<std::size_t, std::unique_ptr<BusTap>> buses_;
};

}  // namespace stator::rack
