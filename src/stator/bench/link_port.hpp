#pragma once

#include "stator/link/ethernet/ethernet_link.hpp"
#include "stator/master/frame_port.hpp"
#include "stator/rack/world/clock.hpp"

namespace stator::bench {

/// A master's port onto a network interface; time is the machine's.
class LinkPort final : public master::FramePort {
 public:
  /// `link` must outlive the port.
  explicit LinkPort(link::EthernetLink& link) : link_(link) {}

  master::Result<std::size_t> exchange(std::span<const std::byte> frame, std::span<std::byte> reply,
                                       base::SimDuration timeout) override;
  void wait(base::SimDuration duration) override;
  [[nodiscard]] base::SimTime now() override { return clock_.now(); }

 private:
  link::EthernetLink& link_;
  rack::RealClock clock_;
};

}  // namespace stator::bench
