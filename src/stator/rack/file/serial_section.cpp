#include "stator/rack/file/serial_section.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/link/serial/serial_link.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/file/device_section.hpp"
#include "stator/rack/file/rack_file.hpp"

namespace stator::rack {

namespace {

using namespace base::literals;

constexpr std::array kLineRows{
    settings::text<&SerialLineConfiguration::link>("link", "The line as devices name it"),
    settings::boolean<&SerialLineConfiguration::pacing>(
        "pacing", "Bytes take the time of their bits at the devices' baud rate"),
    settings::word<&SerialLineConfiguration::wait>("wait", kWaitModes,
                                                   "How its thread waits for bytes"),
    settings::duration<&SerialLineConfiguration::spin_time>("spin_time", {1_us, 1_s},
                                                            "Of wait = adaptive"),
    settings::whole<&SerialLineConfiguration::cpu>("cpu", kProcessors,
                                                   "Processor the line's thread is tied to"),
};
constexpr settings::Section<SerialLineConfiguration> kLineKeys{kLineRows};

/// One end of a line at a device.
struct LineEnd {
  std::string device;
  std::string interface;
};

/// The lines that devices of the rack name, with their ends.
std::map<std::string, std::vector<LineEnd>> lines_of_devices(
    const RackConfiguration& configuration) {
  std::map<std::string, std::vector<LineEnd>> lines;
  const auto add = [&lines](const std::vector<DeviceConfiguration>& devices) {
    for (const DeviceConfiguration& device : devices) {
      for (const SerialConnection& connection : device.serial) {
        lines[connection.line].push_back({device.name, connection.interface});
      }
    }
  };
  for (const SegmentConfiguration& segment : configuration.segments) {
    add(segment.devices);
  }
  for (const BusConfiguration& bus : configuration.buses) {
    add(bus.devices);
  }
  return lines;
}

/// Only RS-485 and RS-422 take more than two ends: the program's and a device's.
void check_ends(TableReader& root, const std::string& line, const std::vector<LineEnd>& ends) {
  const auto point_to_point = std::ranges::find_if(ends, [](const LineEnd& end) {
    return end.interface != "rs485" && end.interface != "rs422";
  });
  if (ends.size() > 1 && point_to_point != ends.end()) {
    root.refuse("device",
                fmt::format("the line \"{}\" of {}.{} is named {} times; only rs485 and "
                            "rs422 share a line, so give each of the others its own",
                            line, point_to_point->device, point_to_point->interface, ends.size()));
  }
}

SerialLineConfiguration read_line(TableReader& section) {
  SerialLineConfiguration line;
  settings::read_keys(kLineKeys, section, line);
  if (!section.contains("link") || section.is_refused("link")) {
    section.missing("link",
                    fmt::format("it is the line as devices name it, {}", link::kSerialLinkForms));
  }
  return line;
}

}  // namespace

std::vector<SerialConnection> read_serial_connections(TableReader& section,
                                                      const product::Identity& identity) {
  std::vector<SerialConnection> connections;
  for (const auto& [interface, protocol, baud_rate] : identity.serial_interfaces) {
    const std::optional<std::string> line =
        section.text({interface, "Serial line at that interface: pty:PATH or tcp:[ADDRESS:]PORT"});
    if (!line) {
      continue;
    }
    if (const auto address = link::parse_serial_link(*line); !address) {
      section.refuse(interface, address.error().text);
    }
    connections.push_back({interface, *line});
  }
  return connections;
}

void read_line_devices(TableReader& root, DeviceReading& reading,
                       std::vector<BusConfiguration>& buses) {
  BusConfiguration bus = bus_without_wire();
  for (TableReader& section :
       root.sections({"device", "Devices that are reached over serial lines only"})) {
    section.attempt([&] {
      read_device(section, reading, NetworkKind::bus, [&](DeviceConfiguration device) {
        if (device.serial.empty()) {
          section.refuse(
              "type",
              fmt::format(
                  "\"{}\" cannot be reached: a [[device]] needs a serial line; write "
                  "{} = \"{}\", or put it on a [[bus]]",
                  device.name,
                  fmt::join(device.setup.product().identity().serial_interface_names(), " or "),
                  link::kSerialLinkForms));
        }
        section.finish();
        bus.devices.push_back(std::move(device));
      });
    });
  }
  if (!bus.devices.empty()) {
    buses.push_back(std::move(bus));
  }
}

void read_lines(TableReader& root, RackConfiguration& configuration) {
  std::set<std::string> named;
  for (const auto& [line, ends] : lines_of_devices(configuration)) {
    check_ends(root, line, ends);
    named.insert(line);
  }
  for (TableReader& section :
       root.sections({"line", "How bytes pass over a serial line that devices name"})) {
    section.attempt([&] {
      SerialLineConfiguration line = read_line(section);
      if (!named.contains(line.link)) {
        section.fail_for_reference(
            "link",
            fmt::format(R"("link" is "{}", which no device names; {})", line.link,
                        named.empty() ? "give a device a serial line"
                                      : fmt::format("the lines are: {}", fmt::join(named, ", "))));
      }
      if (std::ranges::find(configuration.lines, line.link, &SerialLineConfiguration::link) !=
          configuration.lines.end()) {
        section.refuse("link", fmt::format("the line \"{}\" has two [[line]] tables", line.link));
      }
      configuration.lines.push_back(std::move(line));
      section.finish();
    });
  }
}

}  // namespace stator::rack
