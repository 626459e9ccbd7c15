#include "stator/rack/file/rack_file.hpp"

#include <array>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/link/ethernet/link_address.hpp"
#include "stator/link/serial/chip_server.hpp"
#include "stator/product/catalogue/catalogue.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/core/wiring.hpp"
#include "stator/rack/file/bus_section.hpp"
#include "stator/rack/file/device_section.hpp"
#include "stator/rack/file/event_section.hpp"
#include "stator/rack/file/fault_section.hpp"
#include "stator/rack/file/late_boot.hpp"
#include "stator/rack/file/rack_file_steps.hpp"
#include "stator/rack/file/serial_section.hpp"
#include "stator/rack/file/system_files.hpp"
#include "stator/rack/file/wire_section.hpp"
#include "stator/rack/file/wiring_section.hpp"
#include "stator/settings/key.hpp"
#include "stator/settings/path.hpp"

namespace stator::rack {

namespace {

constexpr base::SimDuration kLongestPeriod(3'600'000'000'000);
using namespace base::literals;

/// The types of the products for which `is_so` holds.
template <typename Predicate>
std::vector<std::string> types_of_products(const product::Catalogue& catalogue, Predicate is_so) {
  std::vector<std::string> types;
  for (const auto& product : catalogue.products()) {
    if (is_so(*product)) {
      types.push_back(product->identity().type);
    }
  }
  return types;
}

/// Switches Ethernet over EtherCAT on, bridged to a TAP interface.
void read_eoe(TableReader& section, const product::Catalogue& catalogue,
              DeviceConfiguration& device) {
  const std::optional<std::string> eoe = section.text(
      {"eoe", "tap:NAME: switches Ethernet over EtherCAT on and bridges it to that TAP interface"});
  if (!eoe) {
    return;
  }
  const auto address = link::parse_link_address(*eoe);
  if (!address || address->kind != link::LinkKind::tap) {
    section.refuse("eoe", fmt::format(R"("eoe" is "{}"; write "tap:NAME")", *eoe));
    return;
  }
  device.eoe_interface = address->name;
  if (product::CoeOptions* const coe = device.setup.coe(); coe != nullptr) {
    coe->ethernet_over_ethercat = true;
  } else {
    const auto with_coe = types_of_products(catalogue, [](const product::Product& product) {
      const product::Setup setup = product.defaults();
      return setup.coe() != nullptr;
    });
    section.refuse(
        "eoe",
        "this chip has no firmware of its own whose mailbox could carry Ethernet; "
        "firmware at its pins may offer EoE itself" +
            (with_coe.empty() ? std::string()
                              : fmt::format(", or run a {}", fmt::join(with_coe, " or "))));
  }
}

/// The socket for the firmware beside a chip.
void read_host_link(TableReader& section, const product::Catalogue& catalogue,
                    DeviceConfiguration& device) {
  const std::optional<std::string> text = section.text(
      {"spi", "unix:PATH or tcp:[ADDRESS:]PORT: socket for the firmware beside a chip"});
  if (!text) {
    return;
  }
  device.host_link = *text;
  if (!device.setup.product().identity().host_port) {
    const auto chips = types_of_products(
        catalogue, [](const product::Product& product) { return product.identity().host_port; });
    section.refuse("spi",
                   "this product has no pins for a firmware of yours; \"spi\" belongs to a chip" +
                       (chips.empty() ? std::string() : ", e.g. a " + chips.front()));
  } else if (const auto checked = link::check_chip_link(*text); !checked) {
    section.refuse("spi", checked.error().text);
  } else {
    section.claim("spi", *text);
  }
}

void read_segment_device(TableReader& section, DeviceReading& reading,
                         std::vector<DeviceConfiguration>& devices) {
  read_device(section, reading, NetworkKind::segment, [&](DeviceConfiguration device) {
    read_eoe(section, reading.catalogue, device);
    read_host_link(section, reading.catalogue, device);
    devices.push_back(std::move(device));
    section.attempt([&] { read_wiring(section, devices); });
    section.finish();
  });
}

template <link::LinkAddress SegmentConfiguration::*Link>
void read_link(const settings::KeyWords& key, settings::Reader& reader,
               SegmentConfiguration& segment) {
  const std::optional<std::string> text = reader.text(key);
  if (!text) {
    return;
  }
  const auto address = link::parse_link_address(*text);
  if (!address) {
    reader.refuse(key.name, address.error().text);
    return;
  }
  segment.*Link = *address;
}

constexpr std::array kSegmentRows{
    settings::custom<SegmentConfiguration, read_link<&SegmentConfiguration::link>>(
        "link", "ethercat:INTERFACE, udp:ADDRESS[:PORT], tap:NAME or in-process"),
    settings::custom<SegmentConfiguration, read_link<&SegmentConfiguration::redundant_link>>(
        "redundant",
        "The master's second interface, at the free end of the last device: cable redundancy"),
    settings::word<&SegmentConfiguration::wait>("wait", kWaitModes,
                                                "How its thread waits for frames"),
    settings::duration<&SegmentConfiguration::spin_time>("spin_time", {1_us, 1_s},
                                                         "Of wait = adaptive"),
    settings::whole<&SegmentConfiguration::cpu>("cpu", kProcessors,
                                                "Processor the segment's thread is tied to"),
    settings::output<&SegmentConfiguration::capture>(
        "capture", "pcap file of everything that crosses the link"),
};
constexpr std::array kSegmentRules{settings::Rule<SegmentConfiguration>{
    "redundant", [](const SegmentConfiguration& segment, const settings::Reader&) {
      return redundancy_problem(segment);
    }}};
constexpr settings::Section<SegmentConfiguration> kSegmentKeys{kSegmentRows, kSegmentRules};

constexpr std::array kRecordRows{
    settings::output<&RecordConfiguration::file>("file", "CSV file to write"),
    settings::duration<&RecordConfiguration::period>("period", {1_us, kLongestPeriod},
                                                     "Simulated time between two rows"),
    settings::texts<&RecordConfiguration::signals>("signals", "Names with * as wild card"),
};
constexpr settings::Section<RecordConfiguration> kRecordKeys{kRecordRows};

constexpr std::array kRackRows{
    settings::word<&RackConfiguration::clock>(
        "clock", kClockKinds,
        "real: the machine's time; lockstep: time moves only with the master"),
    settings::duration<&RackConfiguration::cycle>(
        "cycle", {50_us, 1_s},
        "Lockstep: simulated time per process-data exchange, on a CAN bus per SYNC"),
    settings::duration<&RackConfiguration::step>("step", {1_us, 1_s},
                                                 "Lockstep: simulated time per other frame"),
    settings::text<&RackConfiguration::state>(
        "state", "Directory in which devices keep what outlives power"),
};
constexpr settings::Section<RackConfiguration> kRackKeys{kRackRows};

SegmentConfiguration read_segment(TableReader& section, DeviceReading& reading) {
  SegmentConfiguration segment;
  settings::read_keys(kSegmentKeys, section, segment);
  for (TableReader& device :
       section.sections({"device", "The EtherCAT slaves, first = next to the master"})) {
    device.attempt([&] { read_segment_device(device, reading, segment.devices); });
  }
  if (segment.devices.empty() && section.sections("device").empty()) {
    section.refuse("device", "a segment needs at least one [[segment.device]]");
  }
  section.finish();
  return segment;
}

RecordConfiguration read_record(TableReader section) {
  RecordConfiguration record;
  settings::read_keys(kRecordKeys, section, record);
  if (record.file.empty()) {
    section.refuse_missing("file", "it names the CSV file to write");
  }
  section.finish();
  return record;
}

}  // namespace

RackConfiguration read_rack(TableReader& root, const product::Catalogue& catalogue) {
  RackConfiguration configuration;
  settings::read_keys(kRackKeys, root, configuration);
  DeviceReading devices{catalogue};
  for (TableReader& segment :
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
  for (TableReader& event : root.sections({"event", "What happens at a given time"})) {
    event.attempt([&] { events.read(event, configuration.events); });
  }
  read_faults(root, configuration);
  apply_late_boot(configuration);
  WireSectionReader wires(configuration);
  for (TableReader& wire :
       root.sections({"wire", "What a signal of one device does to an input of another"})) {
    wire.attempt([&] { configuration.wires.push_back(wires.read(wire)); });
  }
  root.finish();
  if (const auto* const names = root.reading().named_files) {
    configuration.named_files = *names;
  }
  return configuration;
}

settings::Value parse_rack_tree(std::string_view text, const std::string& name) {
  auto tree = tree_of_text(text, name);
  if (!tree) {
    throw RackFileError(tree.error());
  }
  return std::move(*tree);
}

RackConfiguration read_rack_tree(settings::Value tree, const std::string& name,
                                 const product::Catalogue& catalogue, Changes changes,
                                 const settings::Files& files) {
  settings::Problems problems;
  apply_changes(changes, tree, problems);
  if (!problems.list.empty()) {
    throw RackFileError(problems.list.front());
  }
  RackConfiguration configuration;
  const auto read = [&](TableReader& root) { configuration = read_rack(root, catalogue); };
  read_tree(tree, name, "the rack", read, files);
  return configuration;
}

RackConfiguration parse_rack_file(std::string_view text, const std::string& name,
                                  const product::Catalogue& catalogue) {
  return read_rack_tree(parse_rack_tree(text, name), name, catalogue);
}

std::string read_rack_text(const std::string& path, std::string_view what) {
  auto text = system_files().content(path);
  if (!text) {
    throw RackFileError(
        settings::Problem(fmt::format("{}: cannot read the {}: {}; check the path and its "
                                      "permissions",
                                      path, what, text.error())));
  }
  return std::move(*text);
}

RackConfiguration load_rack_file(const std::string& path, const product::Catalogue& catalogue,
                                 Changes changes) {
  return read_rack_tree(parse_rack_tree(read_rack_text(path), path), path, catalogue, changes);
}

RackConfiguration load_single_device(const std::string& type, const product::Catalogue& catalogue,
                                     Changes changes) {
  RackConfiguration configuration = single_device_rack(type, catalogue);
  if (changes.empty()) {
    return configuration;
  }
  const bool on_bus = configuration.segments.empty();
  settings::Value tree;
  static_cast<void>(
      settings::set(tree, settings::Path{on_bus ? "bus" : "segment", 0U, "device", 0U, "type"},
                    settings::Value(type)));
  return read_rack_tree(std::move(tree), "", catalogue, changes);
}

}  // namespace stator::rack
