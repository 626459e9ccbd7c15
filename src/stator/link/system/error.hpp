// Why a link could not be opened, send or receive: a code for programs and a sentence for people.
#pragma once

#include <cstdint>
#include <string>

namespace stator::link {

enum class LinkErrorCode : std::uint8_t {
  interface_missing,  ///< no network interface of that name
  interface_down,     ///< the interface exists but is not up
  not_permitted,      ///< the process lacks a privilege
  frame_length,       ///< the frame is shorter or longer than the link carries
  interface_taken,    ///< another program holds the interface, or it is of another kind
  address_in_use,     ///< another program listens there
  address_missing,    ///< not an address of this machine
  peer_missing,       ///< nobody is at the other end
  queue_full,         ///< the other side does not take its frames; this one was dropped
  file,               ///< a capture file cannot be created or written
  invalid_option,     ///< an option names something the machine does not have
  system,             ///< any other refusal of the operating system
};

/// Why a link could not do what was asked. `text` is for people: what, where, and what to do.
struct LinkError {
  LinkErrorCode code = LinkErrorCode::system;
  std::string text;
};

}  // namespace stator::link
