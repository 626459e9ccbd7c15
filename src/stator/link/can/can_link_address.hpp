// Texts that name a port of a CAN bus, such as "slcan:PATH" or "socketcan:INTERFACE", and what they
// mean.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "stator/base/expected.hpp"
#include "stator/link/system/error.hpp"

namespace stator::link {

enum class CanLinkKind : std::uint8_t {
  slcan,          ///< "slcan:PATH": LAWICEL ASCII on a pseudo-terminal
  slcan_tcp,      ///< "slcan-tcp:[ADDRESS:]PORT": the same over TCP
  socketcand,     ///< "socketcand:[ADDRESS:]PORT"
  socketcan,      ///< "socketcan:INTERFACE": a CAN interface of the kernel
  udp_multicast,  ///< "udp-multicast:[GROUP[:PORT]]", as python-can has it
  can_exec,       ///< "can-exec:NAME": programs started by "stator can-exec"
};

/// The forms parse_can_link_address() reads, for messages and help texts.
inline constexpr std::string_view kCanLinkForms =
    "slcan:PATH, slcan-tcp:[ADDRESS:]PORT, socketcand:[ADDRESS:]PORT, socketcan:INTERFACE, "
    "udp-multicast:[GROUP[:PORT]] or can-exec:NAME";

/// A port of a CAN bus as people write it. Options stand behind commas.
struct CanLinkAddress {
  CanLinkKind kind = CanLinkKind::slcan;
  std::string name;          ///< path, address, group or name
  std::uint16_t port = 0;    ///< of those over IP; 0: any free one
  bool acknowledge = false;  ///< ",acknowledge" of slcan: z and Z for each frame taken
  bool beacon = false;       ///< ",beacon" of socketcand: tell the network by UDP broadcasts

  friend bool operator==(const CanLinkAddress&, const CanLinkAddress&) = default;
};

/// The address at which servers listen when none is given: this machine only.
inline constexpr std::string_view kLoopback = "127.0.0.1";
inline constexpr std::uint16_t kSocketcandPort = 29536;
/// python-can's own group and port.
inline constexpr std::string_view kMulticastGroup = "239.74.163.2";
inline constexpr std::uint16_t kMulticastPort = 43113;

[[nodiscard]] base::Expected<CanLinkAddress, LinkError> parse_can_link_address(
    std::string_view text);

/// The reverse; what was left out is written.
[[nodiscard]] std::string to_text(const CanLinkAddress& address);

/// What a program on this machine gives python-can's `can.Bus()` to reach the port, e.g.
/// `interface="socketcan", channel="can0"`. Of can-exec: a program that is started by it.
[[nodiscard]] std::string python_can_arguments(const CanLinkAddress& address);

}  // namespace stator::link
