#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "stator/base/expected.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/link/system/error.hpp"

namespace stator::link {

/// Longest Ethernet frame without frame check sequence, with room for one VLAN tag (IEEE 802.3
/// §3.2.7). A buffer of this size receives every frame whole.
inline constexpr std::size_t kMaximumFrameLength = 1518;
/// Destination, source and EtherType: what every frame has.
inline constexpr std::size_t kEthernetHeaderLength = 14;

/// What crossed a link since it was opened.
struct LinkStatistics {
  std::uint64_t frames_received = 0;
  std::uint64_t bytes_received = 0;
  std::uint64_t frames_sent = 0;
  std::uint64_t bytes_sent = 0;
  std::uint64_t send_errors = 0;     ///< frames that could not be handed to the medium
  std::uint64_t frames_dropped = 0;  ///< arrived, but lost because nobody took them in time
};

/// One end of an Ethernet medium that carries whole frames, from the destination address to the
/// last byte before the frame check sequence; nothing is padded, cut or changed.
///
/// One thread at a time may receive and one may send; wake() and statistics() may be called by any.
class EthernetLink {
 public:
  EthernetLink() = default;
  EthernetLink(const EthernetLink&) = delete;
  EthernetLink& operator=(const EthernetLink&) = delete;
  virtual ~EthernetLink() = default;

  /// Waits at most `timeout` of the machine's time for a frame and copies it into `buffer`. Returns
  /// its length, or 0 when none came or wake() was called; a signal that interrupts the wait also
  /// ends it with 0. A frame longer than `buffer` is cut to it. `timeout` 0 looks and returns at
  /// once.
  [[nodiscard]] virtual base::Expected<std::size_t, LinkError> receive(
      std::span<std::byte> buffer, base::SimDuration timeout) = 0;

  /// Hands `frame` to the medium. A failure is counted in the statistics and concerns this frame
  /// only: the link stays usable.
  virtual base::Expected<void, LinkError> send(std::span<const std::byte> frame) = 0;

  /// Makes the present receive(), or else the next one, return 0 soon. For shutting down, from
  /// any thread; that of RawEthernetLink also from a signal handler.
  virtual void wake() noexcept = 0;

  /// Something is connected at the other end. A medium that cannot tell says so too.
  [[nodiscard]] virtual bool has_carrier() const { return true; }

  [[nodiscard]] virtual LinkStatistics statistics() const = 0;

  /// How people name it, e.g. "eth1".
  [[nodiscard]] virtual const std::string& name() const = 0;
};

}  // namespace stator::link
