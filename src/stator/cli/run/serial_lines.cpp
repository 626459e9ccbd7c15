#include "stator/cli/run/serial_lines.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/canopen/nmt/node.hpp"
#include "stator/cli/failure.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/run/connections.hpp"

namespace stator::cli {

namespace {

constexpr unsigned kSerialAddresses = 0x100;
constexpr unsigned kCanIdentifiers = 0x800;
constexpr std::string_view kShared = "rs485";

void count_tmcl_address(product::TmclAddress& tmcl, unsigned offset) {
  const unsigned address = tmcl.serial + offset;
  unsigned identifier = tmcl.can + offset;
  const unsigned reply = tmcl.can_reply;
  if (tmcl.can < reply && identifier >= reply) {
    ++identifier;
  }
  if (address >= kSerialAddresses || identifier >= kCanIdentifiers) {
    throw Failure(fmt::format("--count {}: a serial line has addresses up to {}", offset + 1,
                              kSerialAddresses - 1));
  }
  tmcl.serial = static_cast<std::uint8_t>(address);
  tmcl.can = static_cast<std::uint16_t>(identifier);
}

/// The interface that a line without one means; there is one at least.
std::string default_interface(const std::vector<std::string>& interfaces, std::size_t devices) {
  const bool shared = devices > 1 && std::ranges::find(interfaces, kShared) != interfaces.end();
  return shared ? std::string(kShared) : interfaces.front();
}

rack::SerialConnection connection_of(const std::string& text, const product::Identity& identity,
                                     std::size_t devices) {
  const std::vector<std::string> interfaces = identity.serial_interface_names();
  if (interfaces.empty()) {
    throw Failure(fmt::format("--serial {}: a {} has no serial interface; leave --serial out", text,
                              identity.type));
  }
  const std::size_t equals = text.find('=');
  const bool named = equals != std::string::npos && equals < text.find(':');
  const std::string interface =
      named ? text.substr(0, equals) : default_interface(interfaces, devices);
  if (std::ranges::find(interfaces, interface) == interfaces.end()) {
    throw Failure(fmt::format("--serial {}: a {} has no interface \"{}\"; it has {}", text,
                              identity.type, interface, fmt::join(interfaces, ", ")));
  }
  if (devices > 1 && interface != kShared && interface != "rs422") {
    throw Failure(
        fmt::format("--serial {}: {} devices cannot share the line of a {}; only rs485 and "
                    "rs422 are shared, give the others a rack file",
                    text, devices, interface));
  }
  std::string line = named ? text.substr(equals + 1) : text;
  if (const auto address = link::parse_serial_link(line); !address) {
    throw Failure(address.error().text);
  }
  return {interface, std::move(line)};
}

template <typename Visit>
void for_each_device(const rack::RackConfiguration& configuration, const Visit& visit) {
  for (const rack::SegmentConfiguration& segment : configuration.segments) {
    std::ranges::for_each(segment.devices, visit);
  }
  for (const rack::BusConfiguration& bus : configuration.buses) {
    std::ranges::for_each(bus.devices, visit);
  }
}

std::string serial_address_text(const product::Setup& setup) {
  const product::TmclAddress* const tmcl = setup.tmcl_address();
  return tmcl != nullptr ? fmt::format(", address {}", tmcl->serial) : "";
}

}  // namespace

void count_address(product::Setup& setup, unsigned offset) {
  if (std::uint8_t* const node_id = setup.node_id(); node_id != nullptr) {
    if (*node_id + offset > canopen::kMaximumNodeId) {
      throw Failure(fmt::format("--count {}: a CAN bus has node-IDs up to {}", offset + 1,
                                canopen::kMaximumNodeId));
    }
    *node_id = static_cast<std::uint8_t>(*node_id + offset);
  } else if (product::TmclAddress* const tmcl = setup.tmcl_address(); tmcl != nullptr) {
    count_tmcl_address(*tmcl, offset);
  }
}

std::string address_text(const product::Setup& setup) {
  if (const std::uint8_t* const node_id = setup.node_id(); node_id != nullptr) {
    return canopen::is_node_id(*node_id) ? fmt::format(", node-ID {}", *node_id)
                                         : ", without a node-ID";
  }
  const product::TmclAddress* const tmcl = setup.tmcl_address();
  return tmcl == nullptr
             ? ""
             : fmt::format(", identifier {}, replies to {}", tmcl->can, tmcl->can_reply);
}

void connect_serial_lines(const std::vector<std::string>& lines,
                          rack::RackConfiguration& configuration) {
  for (const std::string& text : lines) {
    auto& devices = configuration.segments.empty() ? configuration.buses.front().devices
                                                   : configuration.segments.front().devices;
    const rack::SerialConnection connection =
        connection_of(text, devices.front().setup.product().identity(), devices.size());
    for (rack::DeviceConfiguration& device : devices) {
      device.serial.push_back(connection);
    }
  }
}

void print_line(const rack::RackConfiguration& configuration,
                const rack::SerialLineConfiguration& line, const link::SerialLink& link) {
  fmt::print("Serial line {}{}:\n", link.name(), line.pacing ? ", paced" : "");
  for_each_device(configuration, [&line](const rack::DeviceConfiguration& device) {
    for (const rack::SerialConnection& connection : device.serial) {
      if (connection.line == line.link) {
        fmt::print("  {}  ({}, {}{})\n", device.name, device.setup.product().identity().name(),
                   connection.interface, serial_address_text(device.setup));
      }
    }
  });
  fmt::print("{}", rack::printed(rack::connections_of(configuration, line, link.name())));
}

}  // namespace stator::cli
