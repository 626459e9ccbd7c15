#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "stator/base/expected.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/link/ethernet/raw_ethernet_link.hpp"
#include "stator/link/system/receive_wait.hpp"

namespace stator::link {

/// Waits for frames on two network interfaces at once, for cable redundancy. One thread uses it.
class LinkPairReceiver {
 public:
  /// Waits as `wait` and `spin_time` say, whatever the links themselves were opened with. Both must
  /// outlive this.
  LinkPairReceiver(RawEthernetLink& first, RawEthernetLink& second, WaitMode wait,
                   base::SimDuration spin_time)
      : links_{&first, &second}, wait_(wait, spin_time) {}

  struct Received {
    std::size_t length = 0;  ///< 0: none came in time, or wake() was called
    std::size_t link = 0;    ///< 0 or 1: where it came from
  };

  /// The next frame of either link, taken in turn when both have some. Waits at most `timeout` of
  /// the machine's time; like EthernetLink::receive() otherwise, except that an interface that is
  /// switched off is silent and no error: the other one goes on.
  [[nodiscard]] base::Expected<Received, LinkError> receive(std::span<std::byte> buffer,
                                                            base::SimDuration timeout);

  /// Ends the present receive() or the next one. From any thread and from a signal handler.
  void wake() noexcept { wait_.wake(); }

 private:
  friend class ReceiveWait;

  /// For ReceiveWait: one look at both links, after a sleep of at most `wait`.
  [[nodiscard]] base::Expected<ReceiveWait::Taken, LinkError> take(std::span<std::byte> buffer,
                                                                   base::SimDuration wait);
  [[nodiscard]] bool sleep(base::SimDuration limit) const;

  std::array<RawEthernetLink*, 2> links_;
  ReceiveWait wait_;
  std::size_t preferred_ = 0;  ///< link to look at first
  std::size_t source_ = 0;     ///< link of the last frame
};

}  // namespace stator::link
