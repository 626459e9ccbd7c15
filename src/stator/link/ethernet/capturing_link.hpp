#pragma once

#include "stator/base/delegate.hpp"
#include "stator/link/ethernet/ethernet_link.hpp"
#include "stator/link/system/pcap_writer.hpp"

namespace stator::link {

/// Records everything that crosses another link, both directions, in the order in which it crosses.
/// One thread at a time uses it. The traffic has priority: what the file does not take is missing
/// in it, and the frames go on.
class CapturingLink final : public EthernetLink {
 public:
  using Clock = base::Delegate<base::SimTime()>;

  /// `link` and `writer` must outlive this; `clock` gives the time stamp of each frame.
  CapturingLink(EthernetLink& link, PcapWriter& writer, Clock clock)
      : link_(link), writer_(writer), clock_(clock) {
    writer_.output().set_when_full(WhenFull::drop);
  }

  base::Expected<std::size_t, LinkError> receive(std::span<std::byte> buffer,
                                                 base::SimDuration timeout) override;
  base::Expected<void, LinkError> send(std::span<const std::byte> frame) override;
  void wake() noexcept override { link_.wake(); }
  [[nodiscard]] bool has_carrier() const override { return link_.has_carrier(); }
  [[nodiscard]] LinkStatistics statistics() const override { return link_.statistics(); }
  [[nodiscard]] const std::string& name() const override { return link_.name(); }

 private:
  EthernetLink& link_;
  PcapWriter& writer_;
  Clock clock_;
};

}  // namespace stator::link
