#pragma once

#include <optional>

#include "base/delegate.hpp"
#include "link/ethernet_link.hpp"
#include "link/pcap_writer.hpp"

namespace stator::link {

/// Records everything that crosses another link, both directions, in the order in which it crosses.
/// One thread at a time uses it. The traffic has priority: when the file cannot be written any more
/// (disk full), capturing ends, capture_error() says why, and the frames go on.
class CapturingLink final : public EthernetLink {
 public:
  using Clock = base::Delegate<base::SimTime()>;

  /// `link` and `writer` must outlive this; `clock` gives the time stamp of each frame.
  CapturingLink(EthernetLink& link, PcapWriter& writer, Clock clock)
      : link_(link), writer_(writer), clock_(clock) {}

  base::Expected<std::size_t, LinkError> receive(std::span<std::byte> buffer,
                                                 base::SimDuration timeout) override;
  base::Expected<void, LinkError> send(std::span<const std::byte> frame) override;
  void wake() noexcept override { link_.wake(); }
  [[nodiscard]] bool has_carrier() const override { return link_.has_carrier(); }
  [[nodiscard]] LinkStatistics statistics() const override { return link_.statistics(); }
  [[nodiscard]] const std::string& name() const override { return link_.name(); }

  /// Why capturing ended early; nothing while it works.
  [[nodiscard]] const std::optional<LinkError>& capture_error() const { return capture_error_; }

 private:
  void capture(std::span<const std::byte> frame);

  EthernetLink& link_;
  PcapWriter& writer_;
  Clock clock_;
  std::optional<LinkError> capture_error_;
};

}  // namespace stator::link
