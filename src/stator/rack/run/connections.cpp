#include "stator/rack/run/connections.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/canopen/nmt/node.hpp"
#include "stator/link/can/can_link_address.hpp"
#include "stator/link/serial/serial_link.hpp"
#include "stator/product/catalogue/product.hpp"

namespace stator::rack {

namespace {

using link::CanLinkKind;

constexpr std::string_view kProgramsGuide = "how-to/clients.md";
constexpr std::string_view kCanGuide = "how-to/can-links.md";
constexpr std::string_view kSerialGuide = "how-to/serial-lines.md";

/// What comes behind S in the command of an slcan adapter that sets the bus's bit rate, for those
/// rates about which programs agree; nothing: it is left as it is.
std::optional<int> slcan_code(const BusConfiguration& bus) {
  constexpr std::array<std::pair<std::uint32_t, int>, 8> kCodes{{{10'000, 0},
                                                                 {20'000, 1},
                                                                 {50'000, 2},
                                                                 {100'000, 3},
                                                                 {125'000, 4},
                                                                 {250'000, 5},
                                                                 {500'000, 6},
                                                                 {1'000'000, 8}}};
  for (const auto& [rate, code] : kCodes) {
    if (bus.bit_rate == rate) {
      return code;
    }
  }
  return std::nullopt;
}

std::vector<int> node_ids(const BusConfiguration& bus) {
  std::vector<int> ids;
  for (const DeviceConfiguration& device : bus.devices) {
    const std::uint8_t* const id = device.setup.node_id();
    if (id != nullptr && canopen::is_node_id(*id)) {
      ids.push_back(*id);
    }
  }
  return ids;
}

/// A port of a bus as programs of this machine reach it.
struct ReachedPort {
  const BusConfiguration& bus;
  link::CanLinkAddress address;

  /// The bit rate with what stands before it, if it is for the program to tell.
  [[nodiscard]] std::string rate(std::string_view before) const {
    const bool slcan = address.kind == CanLinkKind::slcan || address.kind == CanLinkKind::slcan_tcp;
    return slcan && slcan_code(bus) ? fmt::format("{}{}", before, *bus.bit_rate) : "";
  }
  /// What python-can is given.
  [[nodiscard]] std::string arguments() const {
    return python_can_arguments(address) + rate(", bitrate=");
  }
  /// The line that a program in Python begins with if it must be started in a way of its own;
  /// `options` are those of can-exec.
  [[nodiscard]] std::string start(std::string_view options = "") const {
    return address.kind == CanLinkKind::can_exec
               ? fmt::format("# to be started by: stator can-exec {}-- python3 THIS_FILE\n",
                             options)
               : "";
  }
};

Connection python_canopen(const ReachedPort& port, const std::vector<int>& ids) {
  return {.program = "python-canopen",
          .lines = fmt::format("{}import canopen\n\n"
                               "network = canopen.Network()\n"
                               "network.connect({})\n"
                               "for node_id in [{}]:\n"
                               "    node = network.add_node(node_id)\n"
                               "    print(node_id, node.sdo.upload(0x1000, 0).hex())\n"
                               "network.disconnect()",
                               port.start(), port.arguments(), fmt::join(ids, ", ")),
          .explanation = fmt::format("Reads the device type, object 1000h, of {}.",
                                     ids.size() == 1 ? "the node" : "each node"),
          .guide = kProgramsGuide};
}

Connection python_can(const ReachedPort& port) {
  return {.program = "python-can",
          .lines = fmt::format("{}import can\n\n"
                               "with can.Bus({}) as bus:\n"
                               "    for message in bus:\n"
                               "        print(message)",
                               port.start(), port.arguments()),
          .explanation = "Prints every frame as it passes.",
          .guide = kCanGuide};
}

Connection can_utils(const ReachedPort& port, const std::vector<int>& ids) {
  const link::CanLinkAddress& address = port.address;
  Connection tools{.program = "can-utils",
                   .explanation = "Prints every frame as it passes.",
                   .guide = kCanGuide};
  switch (address.kind) {
    case CanLinkKind::can_exec:
      tools.lines = fmt::format("stator can-exec -- candump {}", address.name);
      break;
    case CanLinkKind::socketcan:
      tools.lines = fmt::format("candump {}", address.name);
      break;
    case CanLinkKind::slcan:
      tools.lines = fmt::format(
          "sudo slcand -o{} $(readlink {}) can0\n"
          "sudo ip link set can0 up\n"
          "candump can0",
          slcan_code(port.bus) ? fmt::format(" -s{}", *slcan_code(port.bus)) : "", address.name);
      tools.explanation =
          "slcand makes a CAN interface of the port where the kernel has the module slcan; where "
          "it has not, give the bus a port can-exec:can0.";
      break;
    case CanLinkKind::slcan_tcp:
    case CanLinkKind::socketcand:
    case CanLinkKind::udp_multicast:
      tools.explanation =
          "They speak SocketCAN only: give the bus a port can-exec:can0, then stator can-exec -- "
          "candump can0.";
      break;
  }
  if (!ids.empty() && !tools.lines.empty()) {
    tools.lines += fmt::format("\n{}cansend {} {:X}#4000100000000000",
                               address.kind == CanLinkKind::can_exec ? "stator can-exec -- " : "",
                               address.kind == CanLinkKind::slcan ? "can0" : address.name,
                               0x600 + ids.front());
    tools.explanation += " cansend, in a second terminal, asks a node for its device type.";
  }
  return tools;
}

/// PyTrinamic's socketcan_tmcl takes no other names.
bool is_trinamic_name(std::string_view interface) {
  return interface.size() == 4 && interface.starts_with("can") && interface[3] >= '0' &&
         interface[3] <= '7';
}

/// The interface of PyTrinamic and its port; nothing: it has none for this kind.
std::optional<std::string> trinamic_interface(const ReachedPort& port) {
  const link::CanLinkAddress& address = port.address;
  switch (address.kind) {
    case CanLinkKind::slcan:
      return fmt::format("slcan_tmcl --port {}{}", address.name, port.rate(" --data-rate "));
    case CanLinkKind::socketcan:
    case CanLinkKind::can_exec:
      return fmt::format("socketcan_tmcl --port {}",
                         is_trinamic_name(address.name) ? address.name : "can0");
    case CanLinkKind::slcan_tcp:
    case CanLinkKind::socketcand:
    case CanLinkKind::udp_multicast:
      return std::nullopt;
  }
  return std::nullopt;
}

/// What begins every program with PyTrinamic.
constexpr std::string_view kTrinamicImport =
    "from pytrinamic.connections import ConnectionManager\n\n";

Connection pytrinamic(const ReachedPort& port, const DeviceConfiguration& module,
                      unsigned identifier) {
  Connection trinamic{.program = "PyTrinamic", .guide = kProgramsGuide};
  const auto interface = trinamic_interface(port);
  if (!interface) {
    trinamic.explanation =
        "It has no interface for this kind of port: give the bus a port slcan:/tmp/stator-can0 or "
        "can-exec:can0.";
    return trinamic;
  }
  const bool other_name = !is_trinamic_name(port.address.name);
  trinamic.lines = fmt::format(
      "{}{}module = ConnectionManager(\"--interface {} --module-id {} --host-id {}\").connect()\n"
      "print(module.get_version_string())",
      port.start(other_name ? fmt::format("--bus {}=can0 ", port.address.name) : ""),
      kTrinamicImport, *interface, identifier, module.setup.tmcl_address()->can_reply);
  trinamic.explanation =
      fmt::format("Asks {} for its version. Commands go to identifier {}, replies come from {}.",
                  module.name, identifier, module.setup.tmcl_address()->can_reply);
  return trinamic;
}

template <typename Visit>
void for_each_device(const RackConfiguration& rack, const Visit& visit) {
  for (const SegmentConfiguration& segment : rack.segments) {
    std::ranges::for_each(segment.devices, visit);
  }
  for (const BusConfiguration& bus : rack.buses) {
    std::ranges::for_each(bus.devices, visit);
  }
}

/// How programs talk over a line.
struct LineUse {
  std::string_view class_name = "serial_tmcl";  ///< PyTrinamic's name of it
  std::uint32_t baud_rate = 9600;               ///< of those to which it does not matter
  std::vector<unsigned> addresses;              ///< of modules with TMCL
};

/// What the interface at the line speaks, and how fast: that of the last device named on it.
LineUse use_of(const RackConfiguration& rack, const SerialLineConfiguration& line) {
  LineUse use;
  for_each_device(rack, [&](const DeviceConfiguration& device) {
    const auto found = std::ranges::find(device.serial, line.link, &SerialConnection::line);
    if (found == device.serial.end()) {
      return;
    }
    const product::Product& product = device.setup.product();
    for (const product::SerialInterface& each : product.serial_interfaces(device.setup)) {
      if (each.name == found->interface) {
        const bool registers = each.protocol == product::SerialProtocol::registers;
        use.class_name = registers ? "uart_ic" : "serial_tmcl";
        use.baud_rate = each.baud_rate.value_or(use.baud_rate);
      }
    }
    if (const auto address = product.tmcl_address_on(device.setup, found->interface)) {
      use.addresses.push_back(*address);
    }
  });
  return use;
}

/// `connect` is the expression that opens the line.
Connection pytrinamic(const LineUse& use, const std::string& connect) {
  Connection trinamic{.program = "PyTrinamic",
                      .lines = fmt::format("{}module = {}\n", kTrinamicImport, connect),
                      .guide = kSerialGuide,
                      .printed = fmt::format("  {}   # PyTrinamic\n", connect)};
  if (use.class_name != LineUse{}.class_name) {
    trinamic.lines.pop_back();
    trinamic.explanation = "Opens the line to read the registers of the chip.";
  } else if (use.addresses.empty()) {
    trinamic.lines += "print(module.get_version_string())";
    trinamic.explanation = "Asks the module for its version.";
  } else {
    trinamic.lines += fmt::format(
        "for address in [{}]:\n"
        "    print(address, module.get_version_string(address))",
        fmt::join(use.addresses, ", "));
    trinamic.explanation = fmt::format("Asks {} for its version, by its address.",
                                       use.addresses.size() == 1 ? "the module" : "each module");
  }
  return trinamic;
}

Connection pyserial(const std::string& open) {
  return {.program = "pyserial",
          .lines = "import serial\n\nline = " + open,
          .explanation = "Opens the line for bytes of your own.",
          .guide = kSerialGuide,
          .printed = fmt::format("  {}   # pyserial\n", open)};
}

}  // namespace

Connections connections_of(const BusConfiguration& bus, std::string_view port) {
  Connections connections{.where = fmt::format("Programs connect to {}", port), .programs = {}};
  const auto address = link::parse_can_link_address(port);
  if (!address) {
    return connections;
  }
  const ReachedPort reached{bus, *address};
  const std::vector<int> ids = node_ids(bus);
  if (!ids.empty()) {
    connections.programs.push_back(python_canopen(reached, ids));
  }
  for (const DeviceConfiguration& device : bus.devices) {
    if (const auto identifier = device.setup.product().tmcl_identifier(device.setup)) {
      connections.programs.push_back(pytrinamic(reached, device, *identifier));
    }
  }
  connections.programs.push_back(can_utils(reached, ids));
  connections.programs.push_back(python_can(reached));
  return connections;
}

Connections connections_of(const RackConfiguration& rack, const SerialLineConfiguration& line,
                           std::string_view opened) {
  Connections connections{.where = "Programs open it", .programs = {}};
  const LineUse use = use_of(rack, line);
  const auto address = link::parse_serial_link(line.link);
  if (address && address->kind == link::SerialLinkKind::tcp) {
    if (use.class_name == LineUse{}.class_name) {
      connections.programs.push_back(
          pytrinamic(use, fmt::format("ConnectionManager(\"--interface socket_serial_tmcl --port "
                                      "{}\").connect()",
                                      opened)));
    }
    connections.programs.push_back(
        pyserial(fmt::format("serial.serial_for_url(\"socket://{}\")", opened)));
    return connections;
  }
  connections.programs = {
      pytrinamic(use, fmt::format("ConnectionManager(\"--interface {} --port {} --data-rate "
                                  "{}\").connect()",
                                  use.class_name, opened, use.baud_rate)),
      pyserial(fmt::format("serial.Serial(\"{}\", {})", opened, use.baud_rate))};
  return connections;
}

std::string printed(const Connections& connections) {
  std::string text = connections.where + ":\n";
  for (const Connection& program : connections.programs) {
    text += program.printed;
  }
  return text;
}

}  // namespace stator::rack
