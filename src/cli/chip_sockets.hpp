#pragma once

#include <string>

#include "rack/rack_configuration.hpp"

namespace stator::cli {

/// Opens the socket `link` (link::kChipLinkForms) for the firmware beside the device of a rack that
/// has one device; nothing happens if `link` is empty. Throws Failure for devices that have
/// firmware of their own, and for several chips, which cannot share a socket.
void connect_chip(const std::string& link, rack::RackConfiguration& configuration);

}  // namespace stator::cli
