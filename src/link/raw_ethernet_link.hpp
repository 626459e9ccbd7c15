#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "link/ethernet_link.hpp"
#include "link/file_descriptor.hpp"
#include "link/link_counters.hpp"

namespace stator::link {

/// How a receiving thread waits for the next frame. A sleeping one may notice the end of its
/// timeout one tick of the system's scheduler late (1 to 10 ms), a frame at once.
enum class WaitMode : std::uint8_t {
  block,     ///< sleeps: no load when idle; best when it shares the processor with the master
  spin,      ///< looks again and again: shortest answer from another processor, takes all of it
  adaptive,  ///< spins for `spin_time` after the last frame, then sleeps
};

struct RawEthernetOptions {
  std::string interface;
  WaitMode wait = WaitMode::block;
  base::SimDuration spin_time{200'000};  ///< of WaitMode::adaptive
  /// Lets the kernel poll the network card for this long before it sleeps (SO_BUSY_POLL, rounded to
  /// microseconds); 0 leaves the system's setting. Only some drivers support it.
  base::SimDuration busy_poll{};
};

/// EtherCAT frames on a network interface (Linux AF_PACKET, EtherType 88A4h). Receives frames for
/// every destination address, never those sent by this machine on the interface. Needs CAP_NET_RAW.
/// A sleeping receive() notices wake() within 20 ms.
class RawEthernetLink final : public EthernetLink {
 public:
  /// Opens the interface, which must exist and be up. The error names the interface and the remedy.
  static base::Expected<std::unique_ptr<RawEthernetLink>, LinkError> open(
      const RawEthernetOptions& options);

  base::Expected<std::size_t, LinkError> receive(std::span<std::byte> buffer,
                                                 base::SimDuration timeout) override;
  base::Expected<void, LinkError> send(std::span<const std::byte> frame) override;
  void wake() noexcept override;
  /// Asks the system, which takes about a microsecond.
  [[nodiscard]] bool has_carrier() const override;
  [[nodiscard]] LinkStatistics statistics() const override;
  [[nodiscard]] const std::string& name() const override { return options_.interface; }

  /// For waiting on several links at once with poll().
  [[nodiscard]] int descriptor() const { return socket_.get(); }
  /// The interface's own address, the source address of a master's frames.
  [[nodiscard]] const std::array<std::uint8_t, 6>& mac_address() const { return mac_address_; }

 private:
  explicit RawEthernetLink(const RawEthernetOptions& options) : options_(options) {}

  base::Expected<void, LinkError> set_up();
  base::Expected<void, LinkError> configure_socket(int interface_index);
  base::Expected<std::size_t, LinkError> take_frame(std::span<std::byte> buffer, int flags);
  base::Expected<std::size_t, LinkError> spin(std::span<std::byte> buffer, std::int64_t until);
  base::Expected<std::size_t, LinkError> sleep(std::span<std::byte> buffer,
                                               base::SimDuration timeout);
  bool take_wake();
  bool set_receive_timeout(base::SimDuration timeout);

  RawEthernetOptions options_;
  std::array<std::uint8_t, 6> mac_address_{};
  FileDescriptor socket_;
  std::atomic<bool> wake_requested_ = false;
  bool interrupted_ = false;           ///< a signal ended the last recv
  base::SimDuration receive_timeout_;  ///< as the socket has it
  std::int64_t last_frame_ = 0;        ///< ns of the monotonic clock, for WaitMode::adaptive
  LinkCounters counters_;
  mutable std::atomic<std::uint64_t> frames_dropped_ = 0;
};

}  // namespace stator::link
