#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "link/veth_namespace.hpp"
#include "stator/link/ethernet/raw_ethernet_link.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::benchmarks {

/// Where the two ends of the cable run and how they wait.
enum class Placement : std::uint8_t {
  block_same_core,  ///< both sleep in recv on one processor: no processor has to be woken up
  spin_other_core,  ///< both spin, each on a processor of its own
};

/// What a peer is told: the interface it answers on, how to wait, and when to end.
struct PeerEnd {
  std::string interface;
  link::WaitMode wait;
  const std::atomic<bool>& stop;  ///< to be looked at at least every 100 ms
};

/// Answers every frame that arrives on an interface, until told to stop. Runs in a thread of its
/// own that is pinned already. A rack is measured by writing a peer that runs it.
using Peer = std::function<void(const PeerEnd&)>;

/// The yardstick: the fewest system calls with which a frame can be taken and sent back.
void bare_echo(const PeerEnd& end);

/// A peer that receives and sends through RawEthernetLink and lets `handle` change the frame in
/// between; a frame for which it returns false is not answered.
Peer link_echo(std::function<bool(std::span<std::byte>)> handle);

/// One frame in flight, free running, over a veth pair of its own: what a master sees as the
/// fastest possible cycle. Needs the right to create network namespaces.
class RoundTrip {
 public:
  /// Starts `peer` on the far end. Throws std::runtime_error with the reason when the machine does
  /// not allow it.
  RoundTrip(const Peer& peer, Placement placement);
  ~RoundTrip();
  RoundTrip(const RoundTrip&) = delete;
  RoundTrip& operator=(const RoundTrip&) = delete;

  /// Sends `frame` and waits for an answer `count` times; round trips per second. Throws
  /// std::runtime_error when no answer comes within a second.
  double run(std::span<const std::byte> frame, std::size_t count);

 private:
  void exchange(std::span<const std::byte> frame);
  void wait_for_far_end(std::span<const std::byte> frame);

  Placement placement_;
  std::unique_ptr<link::VethNamespace> veth_;
  link::FileDescriptor near_socket_;
  std::atomic<bool> stop_ = false;
  std::thread far_end_;
};

/// Round trips per second of several peers, measured in turns so that whatever else the machine
/// does concerns all of them alike: the median of `rounds` runs of `count` round trips each.
std::vector<double> compare(std::span<const Peer> peers, Placement placement,
                            std::span<const std::byte> frame, std::size_t rounds,
                            std::size_t count);

}  // namespace stator::benchmarks
