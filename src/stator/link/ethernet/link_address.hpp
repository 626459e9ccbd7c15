// Texts that name an Ethernet link, such as "ethercat:INTERFACE" or "udp:ADDRESS", and what they
// mean.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "stator/base/expected.hpp"
#include "stator/link/system/error.hpp"

namespace stator::link {

enum class LinkKind : std::uint8_t {
  in_process,    ///< no link: slaves and master in one process
  raw_ethernet,  ///< "ethercat:INTERFACE"
  udp,           ///< "udp:ADDRESS" or "udp:ADDRESS:PORT"
  tap,           ///< "tap:NAME"
};

/// The forms parse_link_address() reads, for messages and help texts.
inline constexpr std::string_view kLinkForms = "ethercat:INTERFACE, udp:ADDRESS[:PORT] or tap:NAME";

/// Where a segment's frames come from and go to, as people write it in rack files and on the
/// command line.
struct LinkAddress {
  LinkKind kind = LinkKind::in_process;
  std::string name;        ///< of the interface; IPv4 address of udp
  std::uint16_t port = 0;  ///< of udp

  [[nodiscard]] bool in_process() const { return kind == LinkKind::in_process; }

  friend bool operator==(const LinkAddress&, const LinkAddress&) = default;
};

/// Reads a link as people write it; "in-process" is one, too. The error names the forms there are.
[[nodiscard]] base::Expected<LinkAddress, LinkError> parse_link_address(std::string_view text);

/// The reverse; the port of udp is always written.
[[nodiscard]] std::string to_text(const LinkAddress& address);

}  // namespace stator::link
