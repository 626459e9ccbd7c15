#include <algorithm>
#include <charconv>
#include <cstdint>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "stator/cli/failure.hpp"
#include "stator/cli/option_values.hpp"
#include "stator/cli/products.hpp"
#include "stator/cli/run/chip_sockets.hpp"
#include "stator/cli/run/run_options.hpp"
#include "stator/cli/run/serial_lines.hpp"
#include "stator/link/can/can_link_address.hpp"
#include "stator/link/serial/serial_link.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/file/rack_file.hpp"

namespace stator::cli {

namespace {

/// An option that needs a segment or a bus which the rack has not.
void refuse(bool given, const std::string& option, const std::string& reason) {
  if (given) {
    throw Failure(fmt::format("{} has no place here: {}", option, reason));
  }
}

rack::RackConfiguration base_configuration(const RunOptions& options) {
  if (!options.rack_file.empty()) {
    refuse(!options.serial.empty(), "--serial",
           "a rack file names the serial lines of its devices");
    refuse(!options.spi.empty(), "--spi", "a rack file names the sockets of its chips");
    return rack::load_rack_file(options.rack_file, catalogue(), options.changes);
  }
  if (options.device.empty()) {
    throw Failure(
        "nothing to run; name a rack file, or a product with --device and a link with "
        "--link ethercat:INTERFACE (a CAN device: with --port slcan:/tmp/stator-can0, a serial "
        "one: "
        "with --serial pty:/tmp/stator-serial)");
  }
  rack::RackConfiguration configuration =
      rack::load_single_device(options.device, catalogue(), options.changes);
  auto& devices = configuration.segments.empty() ? configuration.buses.front().devices
                                                 : configuration.segments.front().devices;
  for (unsigned i = 1; i < options.count; ++i) {
    devices.push_back(devices.front());
    devices.back().name = fmt::format("{}-{}", devices.front().name, i + 1);
    count_address(devices.back().setup, i);
  }
  connect_serial_lines(options.serial, configuration);
  connect_chip(options.spi, configuration);
  return configuration;
}

void switch_emergencies_off(rack::RackConfiguration& configuration) {
  for (rack::SegmentConfiguration& segment : configuration.segments) {
    for (rack::DeviceConfiguration& device : segment.devices) {
      if (product::CoeOptions* const coe = device.setup.coe(); coe != nullptr) {
        coe->emergencies = false;
      }
    }
  }
}

void apply_to_segment(const RunOptions& options, rack::SegmentConfiguration& segment) {
  if (!options.link.empty()) {
    segment.link = link_of(options.link);
  }
  if (!options.redundant.empty()) {
    segment.redundant_link = link_of(options.redundant);
  }
  if (!options.wait.empty()) {
    segment.wait = settings::meaning_of<link::WaitMode>(rack::kWaitModes, options.wait);
  }
  if (options.needs_links && segment.link.in_process()) {
    throw Failure(
        fmt::format("the rack has no link to a master; give it with --link as {}. To try Stator "
                    "without any, run \"stator demo\"",
                    link::kLinkForms));
  }
}

/// Without a port a bus whose devices have serial lines needs no wire.
void apply_to_bus(const RunOptions& options, rack::BusConfiguration& bus) {
  bus.ports.insert(bus.ports.end(), options.ports.begin(), options.ports.end());
  if (options.bit_rate == "unlimited") {
    bus.bit_rate = std::nullopt;
  } else if (!options.bit_rate.empty()) {
    std::uint32_t rate = 0;
    const char* end = options.bit_rate.data() + options.bit_rate.size();
    if (std::from_chars(options.bit_rate.data(), end, rate).ptr != end || rate < 5 || rate > 1000) {
      throw Failure(fmt::format(R"(--bit-rate is "{}"; write kbit/s, 5 to 1000, or "unlimited")",
                                options.bit_rate));
    }
    bus.bit_rate = rate * 1000;
  }
  const bool serial = std::ranges::all_of(
      bus.devices, [](const rack::DeviceConfiguration& each) { return !each.serial.empty(); });
  if (!options.needs_links && bus.ports.empty()) {
    return;
  }
  if (bus.ports.empty() && serial && options.rack_file.empty()) {
    refuse(!options.bit_rate.empty(), "--bit-rate", "the devices have serial lines only");
    rack::BusConfiguration without_wire = rack::bus_without_wire();
    without_wire.devices = std::move(bus.devices);
    bus = std::move(without_wire);
    return;
  }
  if (bus.ports.empty()) {
    throw Failure(fmt::format(
        "the bus has no port for programs; give it with --port as {}{}", link::kCanLinkForms,
        options.rack_file.empty()
            ? fmt::format(", or a serial line with --serial as {}", link::kSerialLinkForms)
            : ""));
  }
}

/// Some device is on a CAN bus; buses without wire come last.
bool has_wire(const rack::RackConfiguration& configuration) {
  return !configuration.buses.empty() && configuration.buses.front().wire;
}

/// Of the first segment, or of the first bus in a rack that has none.
void apply_to_first_network(const RunOptions& options, rack::RackConfiguration& configuration) {
  const bool on_bus = configuration.segments.empty();
  if (on_bus && !has_wire(configuration)) {
    refuse(!options.capture.empty(), "--capture", "serial lines cannot be captured");
    refuse(options.cpu.has_value(), "--cpu", "name the processor in a [[line]] of a rack file");
    return;
  }
  if (!options.capture.empty()) {
    (on_bus ? configuration.buses.front().capture : configuration.segments.front().capture) =
        options.capture;
  }
  if (options.cpu) {
    (on_bus ? configuration.buses.front().cpu : configuration.segments.front().cpu) = options.cpu;
  }
}

/// "[DEVICE=]FILE".
rack::TraceConfiguration trace_of(const std::string& text) {
  const std::size_t sign = text.find('=');
  if (sign == std::string::npos) {
    return {.file = text, .device = {}};
  }
  return {.file = text.substr(sign + 1), .device = text.substr(0, sign)};
}

}  // namespace

rack::RackConfiguration configuration_of(const RunOptions& options) {
  rack::RackConfiguration configuration = base_configuration(options);
  if (configuration.segments.empty()) {
    refuse(!options.link.empty() || !options.redundant.empty(), "--link",
           "the rack has no EtherCAT segment; CAN devices are reached over --port");
  } else {
    apply_to_segment(options, configuration.segments.front());
  }
  if (!has_wire(configuration)) {
    refuse(!options.ports.empty(), "--port",
           "the rack has no CAN bus; EtherCAT devices are reached over --link");
    refuse(!options.bit_rate.empty(), "--bit-rate", "the rack has no CAN bus");
  } else {
    apply_to_bus(options, configuration.buses.front());
  }
  apply_to_first_network(options, configuration);
  if (!options.clock.empty()) {
    configuration.clock = settings::meaning_of<rack::ClockKind>(rack::kClockKinds, options.clock);
  }
  if (!options.record.empty() && !is_session(options.record)) {
    configuration.record.emplace();
    configuration.record->file = options.record;
  }
  if (configuration.record && !options.record_period.empty()) {
    configuration.record->period = duration_option("--record-period", options.record_period);
  }
  if (configuration.record && !options.signals.empty()) {
    configuration.record->signals = options.signals;
  }
  if (!options.trace.empty()) {
    configuration.trace = trace_of(options.trace);
    configuration.trace->pins = options.trace_pins;
  }
  if (!options.state.empty()) {
    configuration.state = options.state;
  }
  if (!options.keeps_state) {
    configuration.state.clear();
  }
  if (options.no_emergencies) {
    switch_emergencies_off(configuration);
  }
  return configuration;
}

}  // namespace stator::cli
