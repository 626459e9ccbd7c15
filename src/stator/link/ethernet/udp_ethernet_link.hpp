#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>

#include <netinet/in.h>

#include "stator/link/ethernet/ethernet_link.hpp"
#include "stator/link/ethernet/link_counters.hpp"
#include "stator/link/system/file_descriptor.hpp"
#include "stator/link/system/receive_wait.hpp"
#include "stator/link/system/socket_options.hpp"

namespace stator::link {

/// UDP port of EtherCAT, 88A4h (ETG.1000.4 §5.2).
inline constexpr std::uint16_t kEtherCatUdpPort = 0x88A4;

struct UdpEthernetOptions {
  /// IPv4 in numbers. Where slaves listen: an address of this machine, or 0.0.0.0 for all of them.
  /// Where a master sends: that of the slaves' machine, or a broadcast address.
  std::string address = "0.0.0.0";
  std::uint16_t port = kEtherCatUdpPort;
  WaitMode wait = WaitMode::block;
  base::SimDuration spin_time{200'000};  ///< of WaitMode::adaptive
};

/// EtherCAT over UDP (ETG.1000.3, ETG.1000.4): a datagram carries one EtherCAT frame without its
/// Ethernet header. Needs no privilege. A sleeping receive() notices wake() within 20 ms.
///
/// Towards its users it is a link like any other: receive() makes an Ethernet header around the
/// payload, send() takes it away. The header's destination is the broadcast address and its source
/// 00-00 followed by the sender's IPv4 address. The mark that slaves leave in the source address
/// (bit 1 of its first byte, ETG.1000.4 §5.2) cannot travel, because UDP carries no Ethernet
/// header; a master tells answers from requests by their sender instead. receive() of a master's
/// end sets the mark, so that captures of both ends look as on a wire.
class UdpEthernetLink final : public EthernetLink {
 public:
  /// The slaves' end: takes unicast and broadcast datagrams from anybody. send() answers the sender
  /// of the last frame, from the address to which that came.
  static base::Expected<std::unique_ptr<UdpEthernetLink>, LinkError> listen(
      const UdpEthernetOptions& options);

  /// A master's end: sends to the address. receive() fails with peer_missing if the machine there
  /// says that nobody listens.
  static base::Expected<std::unique_ptr<UdpEthernetLink>, LinkError> connect(
      const UdpEthernetOptions& options);

  base::Expected<std::size_t, LinkError> receive(std::span<std::byte> buffer,
                                                 base::SimDuration timeout) override;
  base::Expected<void, LinkError> send(std::span<const std::byte> frame) override;
  void wake() noexcept override { wait_.wake(); }
  [[nodiscard]] LinkStatistics statistics() const override;
  /// "udp:ADDRESS:PORT"
  [[nodiscard]] const std::string& name() const override { return name_; }

  /// The port listened at or sent from; of interest when it was chosen by the system (port 0).
  [[nodiscard]] std::uint16_t local_port() const;

 private:
  friend ReceiveWait;

  enum class End : std::uint8_t { slaves, master };

  /// Whom send() sends to, and from which address of this machine.
  struct Peer {
    sockaddr_in address{};
    in_addr local{};
    bool known = false;
  };

  UdpEthernetLink(const UdpEthernetOptions& options, End end);

  base::Expected<sockaddr_in, LinkError> open_socket();
  base::Expected<void, LinkError> bind_to(const sockaddr_in& address);
  base::Expected<void, LinkError> connect_to(const sockaddr_in& address);
  base::Expected<ReceiveWait::Taken, LinkError> take(std::span<std::byte> buffer,
                                                     base::SimDuration wait);
  [[nodiscard]] LinkError receive_failure(int error) const;
  [[nodiscard]] LinkError send_failure(int error, std::size_t length) const;
  [[nodiscard]] LinkError nobody_listens() const;

  UdpEthernetOptions options_;
  End end_;
  std::string name_;
  FileDescriptor socket_;
  bool connected_ = false;  ///< the system knows the peer and checks answers' senders
  ReceiveWait wait_;
  SocketReceiveTimeout receive_timeout_;
  std::mutex peer_mutex_;  ///< one thread may receive while another sends
  Peer peer_;
  LinkCounters counters_;
};

}  // namespace stator::link
