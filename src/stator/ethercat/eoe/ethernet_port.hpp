#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "stator/ethercat/standard/frame.hpp"

namespace stator::ethercat {

/// The octets of an IPv4 address in the order in which people write them.
using Ipv4Address = std::array<std::uint8_t, 4>;

/// What "set IP parameter" of EoE can tell a slave (ETG.1000.6 §5.7); what was never told is empty.
struct IpParameters {
  /// Bytes of the DNS name on the wire; shorter names are filled with zeros.
  static constexpr std::size_t kDnsNameSize = 32;

  std::optional<MacAddress> mac_address;
  std::optional<Ipv4Address> address;
  std::optional<Ipv4Address> subnet_mask;
  std::optional<Ipv4Address> default_gateway;
  std::optional<Ipv4Address> dns_server;
  std::optional<std::array<char, kDnsNameSize>> dns_name;

  friend bool operator==(const IpParameters&, const IpParameters&) = default;
};

/// The network behind a slave's EoE: what a board's Ethernet controller or TCP/IP stack would be.
/// Frames run from the destination address to the last byte before the check sequence.
class EthernetPort {
 public:
  EthernetPort() = default;
  EthernetPort(const EthernetPort&) = delete;
  EthernetPort& operator=(const EthernetPort&) = delete;
  virtual ~EthernetPort() = default;

  /// Takes a frame that came from the master; must neither wait nor call back.
  virtual void send(std::span<const std::byte> frame) = 0;

  /// Copies the next frame for the master into `buffer` (EoeServer::kMaximumFrame bytes) and
  /// returns its length; 0 if there is none. Asked often, so it must be cheap then.
  [[nodiscard]] virtual std::size_t take(std::span<std::byte> buffer) = 0;

  /// The master has set IP parameters; all that are known by now.
  virtual void set_ip_parameters(const IpParameters& parameters) = 0;
};

}  // namespace stator::ethercat
