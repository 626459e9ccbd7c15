#include "stator/rack/file/rack_file.hpp"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <set>
#include <span>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "stator/link/ethernet/link_address.hpp"
#include "stator/link/serial/chip_server.hpp"
#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/core/wiring.hpp"
#include "stator/rack/file/bus_section.hpp"
#include "stator/rack/file/device_section.hpp"
#include "stator/rack/file/event_section.hpp"
#include "stator/rack/file/fault_section.hpp"
#include "stator/rack/file/late_boot.hpp"
#include "stator/rack/file/serial_section.hpp"
#include "stator/rack/file/wire_section.hpp"
#include "stator/rack/file/wiring_section.hpp"
#include "stator/rack/toml/rack_file_steps.hpp"

namespace stator::rack {

namespace {

using base::SimDuration;
using namespace base::literals;

/// Switches Ethernet over EtherCAT on, bridged to a TAP interface.
void read_eoe(TomlSection& section, DeviceConfiguration& device) {
  const std::optional<std::string> eoe = section.text(
      {"eoe", "tap:NAME: switches Ethernet over EtherCAT on and bridges it to that TAP interface"});
  if (!eoe) {
    return;
  }
  const auto address = link::parse_link_address(*eoe);
  if (!address || address->kind != link::LinkKind::tap) {
    section.refuse("eoe", fmt::format("\"eoe\" is \"{}\"; write \"tap:NAME\"", *eoe));
    return;
  }
  device.eoe_interface = address->name;
  if (product::CoeOptions* const coe = device.setup.coe(); coe != nullptr) {
    coe->ethernet_over_ethercat = true;
  } else {
    section.refuse("eoe",
                   "this chip has no firmware of its own whose mailbox could carry Ethernet; "
                   "firmware at its pins may offer EoE itself, or run a tmcm-3315 or tmc8670");
  }
}

/// The socket for the firmware beside a chip.
void read_host_link(TomlSection& section, DeviceConfiguration& device) {
  const std::optional<std::string> text = section.text(
      {"spi", "unix:PATH or tcp:[ADDRESS:]PORT: socket for the firmware beside a chip"});
  if (!text) {
    return;
  }
  device.host_link = *text;
  if (!device.setup.product().identity().host_port) {
    section.refuse("spi",
                   "this product has no pins for a firmware of yours; \"spi\" belongs "
                   "to a chip, e.g. a tmc8461");
  } else if (const auto checked = link::check_chip_link(*text); !checked) {
    section.refuse("spi", checked.error().text);
  } else {
    section.claim("spi", *text);
  }
}

DeviceConfiguration read_segment_device(TomlSection& section, DeviceReading& reading,
                                        std::span<const DeviceConfiguration> before) {
  DeviceConfiguration device = read_device(section, reading, NetworkKind::segment);
  read_eoe(section, device);
  read_host_link(section, device);
  section.attempt([&] { read_wiring(section, before, device); });
  section.finish();
  return device;
}

/// Reads the link under `key`, if there is one.
void read_link(TomlSection& section, const TomlKey& key, link::LinkAddress& link) {
  const std::optional<std::string> text = section.text(key);
  if (!text) {
    return;
  }
  const auto address = link::parse_link_address(*text);
  if (!address) {
    section.refuse(key.name, address.error().text);
    return;
  }
  link = *address;
}

SegmentConfiguration read_segment(TomlSection& section, DeviceReading& reading) {
  SegmentConfiguration segment;
  read_link(section, {"link", "ethercat:INTERFACE, udp:ADDRESS[:PORT], tap:NAME or in-process"},
            segment.link);
  read_link(section,
            {"redundant",
             "The master's second interface, at the free end of the last device: cable redundancy"},
            segment.redundant_link);
  if (const std::string problem = redundancy_problem(segment); !problem.empty()) {
    section.refuse("redundant", problem);
  }
  section.choice({"wait", "How its thread waits for frames"}, wait_modes(), segment.wait);
  section.duration({"spin_time", "Of wait = adaptive"}, 1_us, 1_s, segment.spin_time);
  if (const auto cpu =
          section.integer({"cpu", "Processor the segment's thread is tied to"}, 0, 1023)) {
    segment.cpu = static_cast<unsigned>(*cpu);
  }
  segment.capture = section.output({"capture", "pcap file of everything that crosses the link"});
  for (TomlSection& device :
       section.sections({"device", "The EtherCAT slaves, first = next to the master"})) {
    device.attempt(
        [&] { segment.devices.push_back(read_segment_device(device, reading, segment.devices)); });
  }
  if (segment.devices.empty() && section.sections("device").empty()) {
    section.refuse("device", "a segment needs at least one [[segment.device]]");
  }
  section.finish();
  return segment;
}

RecordConfiguration read_record(TomlSection section) {
  RecordConfiguration record;
  record.file = section.output({"file", "CSV file to write"});
  if (record.file.empty()) {
    section.refuse_missing("file", "it names the CSV file to write");
  }
  section.duration({"period", "Simulated time between two rows"}, 1_us,
                   SimDuration(3'600'000'000'000), record.period);
  section.texts({"signals", "Names with * as wild card"}, record.signals);
  section.finish();
  return record;
}

}  // namespace

RackConfiguration read_rack(TomlSection& root, const product::Catalogue& catalogue) {
  RackConfiguration configuration;
  root.choice({"clock", "real: the machine's time; lockstep: time moves only with the master"},
              clock_kinds(), configuration.clock);
  root.duration(
      {"cycle", "Lockstep: simulated time per process-data exchange, on a CAN bus per SYNC"}, 50_us,
      1_s, configuration.cycle);
  root.duration({"step", "Lockstep: simulated time per other frame"}, 1_us, 1_s,
                configuration.step);
  configuration.state =
      root.text({"state", "Directory in which devices keep what outlives power"}).value_or("");
  DeviceReading devices{catalogue};
  for (TomlSection& segment :
       root.sections({"segment", "EtherCAT slaves behind one interface, or two in a ring"})) {
    segment.attempt([&] { configuration.segments.push_back(read_segment(segment, devices)); });
  }
  root.attempt([&] { read_buses(root, devices, configuration.buses); });
  root.attempt([&] { read_line_devices(root, devices, configuration.buses); });
  if (configuration.segments.empty() && configuration.buses.empty() &&
      root.sections("segment").empty() && root.sections("bus").empty() &&
      root.sections("device").empty()) {
    root.refuse("segment", "a rack needs at least one [[segment]], [[bus]] or [[device]]");
  }
  read_lines(root, configuration);
  if (auto record = root.section({"record", "Recording of signals"})) {
    configuration.record = read_record(std::move(*record));
  }
  EventSectionReader events(configuration);
  for (TomlSection& event : root.sections({"event", "What happens at a given time"})) {
    event.attempt([&] { events.read(event, configuration.events); });
  }
  read_faults(root, configuration);
  apply_late_boot(configuration);
  WireSectionReader wires(configuration);
  for (TomlSection& wire :
       root.sections({"wire", "What a signal of one device does to an input of another"})) {
    wire.attempt([&] { configuration.wires.push_back(wires.read(wire)); });
  }
  root.finish();
  return configuration;
}

const std::map<std::string, ClockKind>& clock_kinds() {
  static const std::map<std::string, ClockKind> kinds{{"real", ClockKind::real},
                                                      {"lockstep", ClockKind::lockstep}};
  return kinds;
}

const std::map<std::string, link::WaitMode>& wait_modes() {
  static const std::map<std::string, link::WaitMode> modes{{"block", link::WaitMode::block},
                                                           {"spin", link::WaitMode::spin},
                                                           {"adaptive", link::WaitMode::adaptive}};
  return modes;
}

toml::table parse_toml(std::string_view text, const std::string& name) {
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    const toml::source_position place = error.source().begin;
    throw RackFileError(name, place.line, place.column, "", std::string(error.description()));
  }
}

RackConfiguration parse_rack_file(std::string_view text, const std::string& name,
                                  const product::Catalogue& catalogue) {
  const toml::table table = parse_toml(text, name);
  TomlSection root(name, "the rack", table);
  return read_rack(root, catalogue);
}

std::string read_rack_text(const std::string& path, std::string_view what) {
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file.is_open() || file.bad()) {
    throw RackFileError(
        fmt::format("{}: cannot read the {}: {}; check the path and its permissions", path, what,
                    std::generic_category().message(errno)));
  }
  return text;
}

RackConfiguration load_rack_file(const std::string& path, const product::Catalogue& catalogue) {
  return parse_rack_file(read_rack_text(path), path, catalogue);
}

}  // namespace stator::rack
