#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <linux/netlink.h>

#include "stator/link/can_exec/bus_interface.hpp"

// The messages of rtnetlink(7) about interfaces.
namespace stator::link::can_exec {

/// Takes the message at `offset` of a datagram; nothing if none begins there or it is cut off.
/// `offset` moves behind it.
[[nodiscard]] std::optional<nlmsghdr> take_header(std::span<const std::byte> datagram,
                                                  std::size_t& offset);

/// What a message about interfaces asks for.
struct LinkQuestion {
  enum class Kind : std::uint8_t {
    none,     ///< is about something else, or an interface of the machine
    listing,  ///< of interfaces, the buses among them
    one,      ///< about `bus`
    change,   ///< of `bus`
    empty,    ///< a listing of what `bus` does not have, e.g. its addresses
  };
  Kind kind = Kind::none;
  const Bus* bus = nullptr;
  int error = 0;  ///< that Linux answers a change with
};

/// `message` includes its header.
[[nodiscard]] LinkQuestion read_question(std::span<const std::byte> message);

/// RTM_NEWLINK for `bus` with sequence number and port-ID of `to`.
[[nodiscard]] std::string link_message(const Bus& bus, const nlmsghdr& to, std::uint16_t flags);

}  // namespace stator::link::can_exec
