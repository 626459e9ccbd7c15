#pragma once

#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "stator/link/system/pcap_writer.hpp"
#include "stator/master/frame_port.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/world/clock.hpp"

namespace stator::bench {

/// A master's port onto a rack in the same process, in lockstep: no privileges, no interface, and
/// equal runs give equal results. Waiting is what makes time pass.
class LocalPort final : public master::FramePort {
 public:
  /// Reaches segment `segment` of `rack`, which must outlive the port. `capture` may be null.
  LocalPort(rack::Rack& rack, std::size_t segment, base::SimDuration cycle, base::SimDuration step,
            std::unique_ptr<link::PcapWriter> capture = nullptr);
  /// The same with a clock that ports onto other networks of the rack share; it must outlive them.
  LocalPort(rack::Rack& rack, std::size_t segment, rack::LockstepClock& clock);

  master::Result<std::size_t> exchange(std::span<const std::byte> frame, std::span<std::byte> reply,
                                       base::SimDuration timeout) override;
  void wait(base::SimDuration duration) override;
  [[nodiscard]] base::SimTime now() override { return clock_.now(); }

  /// Frames that have come too late for who sent them, the oldest first.
  [[nodiscard]] const std::deque<std::vector<std::byte>>& late() const { return late_; }
  /// Has these wait in their place.
  void set_late(std::deque<std::vector<std::byte>> frames) { late_ = std::move(frames); }

 private:
  master::Result<std::size_t> capture(std::span<const std::byte> frame);
  void take_late();
  master::Result<std::size_t> wait_for_late(std::span<std::byte> reply, base::SimDuration timeout);

  rack::Rack& rack_;
  std::size_t segment_;
  rack::LockstepClock own_clock_;
  rack::LockstepClock& clock_;
  std::unique_ptr<link::PcapWriter> capture_;
  std::deque<std::vector<std::byte>> late_;  ///< frames that a fault has held up
};

}  // namespace stator::bench
