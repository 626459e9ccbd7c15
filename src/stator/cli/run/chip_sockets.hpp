#pragma once

#include <string>

#include "stator/rack/core/rack_configuration.hpp"

namespace stator::cli {

/// Opens the socket `link` (link::kChipLinkForms) for the firmware beside the device of a rack that
/// has one device; nothing happens if `link` is empty. Throws Failure for devices that have
/// firmware of their own, and for several chips, which cannot share a socket.
void connect_chip(const std::string& link, rack::RackConfiguration& configuration);

/// Says how the firmware of a chip reaches it at `socket`, "unix:PATH" or "tcp:ADDRESS:PORT".
void print_chip(const std::string& socket);

/// Names the chips of a rack that wait for a controller which cannot come: without a socket, and
/// without device emulation, nobody answers the master's requests.
void print_chips_without_firmware(const rack::RackConfiguration& configuration);

}  // namespace stator::cli
