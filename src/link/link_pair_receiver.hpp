#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/expected.hpp"
#include "base/sim_time.hpp"
#include "link/raw_ethernet_link.hpp"

namespace stator::link {

/// Waits for frames on two network interfaces at once, for cable redundancy. One thread uses it.
class LinkPairReceiver {
 public:
  /// Waits as `wait` and `spin_time` say, whatever the links themselves were opened with. Both must
  /// outlive this.
  LinkPairReceiver(RawEthernetLink& first, RawEthernetLink& second, WaitMode wait,
                   base::SimDuration spin_time)
      : links_{&first, &second}, wait_(wait), spin_time_(spin_time) {}

  struct Received {
    std::size_t length = 0;  ///< 0: none came in time
    std::size_t link = 0;    ///< 0 or 1: where it came from
  };

  /// The next frame of either link, taken in turn when both have some. Waits at most `timeout` of
  /// the machine's time; wake() of a link does not shorten that. An interface that is switched off
  /// is silent and no error: the other one goes on.
  [[nodiscard]] base::Expected<Received, LinkError> receive(std::span<std::byte> buffer,
                                                            base::SimDuration timeout);

 private:
  [[nodiscard]] base::Expected<Received, LinkError> take(std::span<std::byte> buffer);
  [[nodiscard]] bool sleep(std::int64_t until) const;

  std::array<RawEthernetLink*, 2> links_;
  WaitMode wait_;
  base::SimDuration spin_time_;
  std::size_t preferred_ = 0;    ///< link to look at first
  std::int64_t last_frame_ = 0;  ///< ns of the monotonic clock
};

}  // namespace stator::link
