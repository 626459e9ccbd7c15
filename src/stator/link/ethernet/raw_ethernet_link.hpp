// EtherCAT frames on a network interface by a raw socket (Linux AF_PACKET), and options of such a
// link.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "stator/link/ethernet/ethernet_link.hpp"
#include "stator/link/ethernet/link_counters.hpp"
#include "stator/link/system/file_descriptor.hpp"
#include "stator/link/system/receive_wait.hpp"
#include "stator/link/system/socket_options.hpp"

namespace stator::link {

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
  void wake() noexcept override { wait_.wake(); }
  /// Asks the system, which takes about a microsecond.
  [[nodiscard]] bool has_carrier() const override;
  [[nodiscard]] LinkStatistics statistics() const override;
  [[nodiscard]] const std::string& name() const override { return options_.interface; }

  /// For waiting on several links at once with poll().
  [[nodiscard]] int descriptor() const { return socket_.get(); }
  /// The interface's own address, the source address of a master's frames.
  [[nodiscard]] const std::array<std::uint8_t, 6>& mac_address() const { return mac_address_; }

 private:
  friend ReceiveWait;

  explicit RawEthernetLink(const RawEthernetOptions& options)
      : options_(options), wait_(options.wait, options.spin_time) {}

  base::Expected<void, LinkError> set_up();
  base::Expected<void, LinkError> configure_socket(int interface_index);
  base::Expected<ReceiveWait::Taken, LinkError> take(std::span<std::byte> buffer,
                                                     base::SimDuration wait);

  RawEthernetOptions options_;
  std::array<std::uint8_t, 6> mac_address_{};
  FileDescriptor socket_;
  ReceiveWait wait_;
  SocketReceiveTimeout receive_timeout_;
  LinkCounters counters_;
  mutable std::atomic<std::uint64_t> frames_dropped_ = 0;
};

}  // namespace stator::link
