#pragma once

#include <string>
#include <vector>

#include "stator/link/serial/serial_link.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/core/rack_configuration.hpp"

namespace stator::cli {

/// Gives one of several like devices its node-ID or addresses: `offset` behind those of the first.
/// CAN identifiers of TMCL modules leave out the one to which all reply. Throws Failure when there
/// are not so many.
void count_address(product::Setup& setup, unsigned offset);

/// What a product is addressed by on a CAN bus, for lists, with a comma in front; empty if it has
/// nothing of the kind.
[[nodiscard]] std::string address_text(const product::Setup& setup);

/// Connects the devices of a rack, which are all of one kind, to `lines`, each
/// "[INTERFACE=]LINE". Without an interface: rs485 if several devices share the line, else the
/// product's first. Throws Failure.
void connect_serial_lines(const std::vector<std::string>& lines,
                          rack::RackConfiguration& configuration);

/// Says which devices are on a line and how programs reach them, ready to paste.
void print_line(const rack::RackConfiguration& configuration,
                const rack::SerialLineConfiguration& line, const link::SerialLink& link);

}  // namespace stator::cli
