#include "stator/cli/run/serial_lines.hpp"

#include <algorithm>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/canopen/nmt/node.hpp"
#include "stator/cli/failure.hpp"
#include "stator/rack/core/product_catalogue.hpp"

namespace stator::cli {

namespace {

constexpr unsigned kSerialAddresses = 0x100;
constexpr unsigned kCanIdentifiers = 0x800;
constexpr std::string_view kShared = "rs485";

void count_tmcl_address(devices::Tmcm142Configuration& configuration, unsigned offset) {
  const unsigned address = configuration.serial_address + offset;
  unsigned identifier = configuration.can_id + offset;
  const unsigned reply = configuration.can_reply_id;
  if (configuration.can_id < reply && identifier >= reply) {
    ++identifier;
  }
  if (address >= kSerialAddresses || identifier >= kCanIdentifiers) {
    throw Failure(fmt::format("--count {}: a serial line has addresses up to {}", offset + 1,
                              kSerialAddresses - 1));
  }
  configuration.serial_address = static_cast<std::uint8_t>(address);
  configuration.can_id = static_cast<std::uint16_t>(identifier);
}

/// The interface that a line without one means.
std::string_view default_interface(const rack::Product& product, std::size_t devices) {
  const auto& interfaces = product.serial_interfaces;
  const bool shared = devices > 1 && std::ranges::find(interfaces, kShared) != interfaces.end();
  return shared ? kShared : interfaces.front();
}

rack::SerialConnection connection_of(const std::string& text, const rack::Product& product,
                                     std::size_t devices) {
  const std::size_t equals = text.find('=');
  const bool named = equals != std::string::npos && equals < text.find(':');
  const std::string interface =
      named ? text.substr(0, equals) : std::string(default_interface(product, devices));
  if (std::ranges::find(product.serial_interfaces, interface) == product.serial_interfaces.end()) {
    throw Failure(fmt::format("--serial {}: a {} has no interface \"{}\"; it has {}", text,
                              product.type, interface, fmt::join(product.serial_interfaces, ", ")));
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

std::string serial_address_text(const rack::ProductConfiguration& product) {
  const auto* const module = std::get_if<devices::Tmcm142Configuration>(&product);
  return module != nullptr ? fmt::format(", address {}", module->serial_address) : "";
}

/// How programs talk over a line.
struct LineUse {
  std::string_view class_name = "serial_tmcl";  ///< PyTrinamic's name of it
  std::uint32_t baud_rate = devices::tmcm_142::kBaudRates.front();
};

/// What the interface at the line speaks, and how fast: that of the last device named on it.
LineUse use_of(const rack::RackConfiguration& configuration,
               const rack::SerialLineConfiguration& line) {
  LineUse use;
  for_each_device(configuration, [&](const rack::DeviceConfiguration& device) {
    const auto found = std::ranges::find(device.serial, line.link, &rack::SerialConnection::line);
    if (found == device.serial.end()) {
      return;
    }
    if (const auto* module = std::get_if<devices::Tmcm142Configuration>(&device.product)) {
      use.baud_rate = devices::tmcm_142::kBaudRates.at(module->baud_rate);
    } else if (std::holds_alternative<devices::Tmc8670Configuration>(device.product)) {
      const bool registers = found->interface == devices::Tmc8670::kSerialInterfaces[1];
      use = registers ? LineUse{"uart_ic", devices::tmc8670::HardwareUart::kDefaultBaudRate}
                      : LineUse{"serial_tmcl", devices::tmc8670::McuUart::kBaudRate};
    }
  });
  return use;
}

/// How programs open the line, ready to paste.
std::string hints(const rack::RackConfiguration& configuration,
                  const rack::SerialLineConfiguration& line, const link::SerialLink& link) {
  const LineUse use = use_of(configuration, line);
  const auto address = link::parse_serial_link(line.link);
  if (address && address->kind == link::SerialLinkKind::tcp) {
    const std::string trinamic =
        use.class_name == LineUse{}.class_name
            ? fmt::format(
                  "  ConnectionManager(\"--interface socket_serial_tmcl --port {}\").connect()   # "
                  "PyTrinamic\n",
                  link.name())
            : "";
    return fmt::format("{1}  serial.serial_for_url(\"socket://{0}\")   # pyserial\n", link.name(),
                       trinamic);
  }
  return fmt::format(
      "  ConnectionManager(\"--interface {2} --port {0} --data-rate {1}\").connect()   # "
      "PyTrinamic\n"
      "  serial.Serial(\"{0}\", {1})   # pyserial\n",
      link.name(), use.baud_rate, use.class_name);
}

}  // namespace

void count_address(rack::ProductConfiguration& product, unsigned offset) {
  std::visit(
      [offset](auto& configuration) {
        if constexpr (requires { configuration.node_id; }) {
          if (configuration.node_id + offset > canopen::kMaximumNodeId) {
            throw Failure(fmt::format("--count {}: a CAN bus has node-IDs up to {}", offset + 1,
                                      canopen::kMaximumNodeId));
          }
          configuration.node_id = static_cast<std::uint8_t>(configuration.node_id + offset);
        } else if constexpr (requires { configuration.serial_address; }) {
          count_tmcl_address(configuration, offset);
        }
      },
      product);
}

std::string address_text(const rack::ProductConfiguration& product) {
  return std::visit(
      [](const auto& configuration) -> std::string {
        if constexpr (requires { configuration.node_id; }) {
          return canopen::is_node_id(configuration.node_id)
                     ? fmt::format(", node-ID {}", configuration.node_id)
                     : ", without a node-ID";
        } else if constexpr (requires { configuration.serial_address; }) {
          return fmt::format(", identifier {}, replies to {}", configuration.can_id,
                             configuration.can_reply_id);
        } else {
          return {};
        }
      },
      product);
}

void connect_serial_lines(const std::vector<std::string>& lines,
                          rack::RackConfiguration& configuration) {
  for (const std::string& text : lines) {
    auto& devices = configuration.segments.empty() ? configuration.buses.front().devices
                                                   : configuration.segments.front().devices;
    const rack::Product& product = *rack::product_of(devices.front().product);
    const rack::SerialConnection connection = connection_of(text, product, devices.size());
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
        fmt::print("  {}  ({}, {}{})\n", device.name, rack::product_name(device.product),
                   connection.interface, serial_address_text(device.product));
      }
    }
  });
  fmt::print("Programs open it:\n{}", hints(configuration, line, link));
}

}  // namespace stator::cli
