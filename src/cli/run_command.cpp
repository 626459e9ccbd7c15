#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/logger.h>

#include "cli/bus.hpp"
#include "cli/chip_sockets.hpp"
#include "cli/commands.hpp"
#include "cli/connection_hints.hpp"
#include "cli/failure.hpp"
#include "cli/logging.hpp"
#include "cli/serial_lines.hpp"
#include "cli/web_server.hpp"
#include "link/can_link.hpp"
#include "link/can_link_address.hpp"
#include "link/chip_server.hpp"
#include "link/serial_link.hpp"
#include "rack/product_catalogue.hpp"
#include "rack/rack_file.hpp"
#include "rack/runner.hpp"
#include "rack/text.hpp"
#include "rack/wiring.hpp"

namespace stator::cli {

namespace {

struct RunOptions {
  std::string rack_file;
  std::string device;
  unsigned count = 1;
  std::string link;
  std::vector<std::string> ports;
  std::vector<std::string> serial;
  std::string spi;
  std::string bit_rate;
  std::string redundant;
  std::string wait;
  std::optional<unsigned> cpu;
  std::string clock;
  std::string capture;
  std::string record;
  std::string record_period;
  std::vector<std::string> signals;
  std::string trace;
  std::vector<std::string> trace_pins;
  std::string duration;
  std::string state;
  bool no_emergencies = false;
  WebOptions web;
};

base::SimDuration duration_option(const std::string& name, const std::string& text) {
  const auto duration = rack::parse_duration(text);
  if (!duration || *duration <= base::SimDuration(0)) {
    throw Failure(
        fmt::format("{} \"{}\" is no duration; write e.g. 1ms, 250us or 10s", name, text));
  }
  return *duration;
}

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
    return rack::load_rack_file(options.rack_file);
  }
  if (options.device.empty()) {
    throw Failure(
        "nothing to run; name a rack file, or a product with --device and a link with "
        "--link ethercat:INTERFACE (a CAN device: with --port slcan:/tmp/stator-can0, a serial "
        "one: "
        "with --serial pty:/tmp/stator-serial)");
  }
  rack::RackConfiguration configuration = rack::single_device_rack(options.device);
  auto& devices = configuration.segments.empty() ? configuration.buses.front().devices
                                                 : configuration.segments.front().devices;
  for (unsigned i = 1; i < options.count; ++i) {
    devices.push_back(devices.front());
    devices.back().name = fmt::format("{}-{}", devices.front().name, i + 1);
    count_address(devices.back().product, i);
  }
  connect_serial_lines(options.serial, configuration);
  connect_chip(options.spi, configuration);
  return configuration;
}

void switch_emergencies_off(rack::RackConfiguration& configuration) {
  for (rack::SegmentConfiguration& segment : configuration.segments) {
    for (rack::DeviceConfiguration& device : segment.devices) {
      std::visit(
          [](auto& product) {
            if constexpr (requires { product.emergencies; }) {
              product.emergencies = false;
            }
          },
          device.product);
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
    segment.wait = rack::wait_modes().at(options.wait);
  }
  if (segment.link.in_process()) {
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
      throw Failure(fmt::format("--bit-rate is \"{}\"; write kbit/s, 5 to 1000, or \"unlimited\"",
                                options.bit_rate));
    }
    bus.bit_rate = rate * 1000;
  }
  const bool serial = std::ranges::all_of(
      bus.devices, [](const rack::DeviceConfiguration& each) { return !each.serial.empty(); });
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

void print_trace_end(const rack::PinTrace& trace, const std::string& file) {
  fmt::print("{}: {} edges and words", file, trace.written());
  if (trace.dropped() != 0) {
    fmt::print(", {} lost because they came faster than they could be written", trace.dropped());
  }
  fmt::print("\n");
  if (!trace.good()) {
    throw Failure(fmt::format("tracing to {} failed; is the disk full?", file));
  }
}

/// The rack file's configuration with the command line's options on top.
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
    configuration.clock = rack::clock_kinds().at(options.clock);
  }
  if (!options.record.empty()) {
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
  if (options.no_emergencies) {
    switch_emergencies_off(configuration);
  }
  return configuration;
}

/// Blocks the signals that end the program in this and all later threads and waits for them here.
class StopSignals {
 public:
  StopSignals() {
    ::sigemptyset(&set_);
    ::sigaddset(&set_, SIGINT);
    ::sigaddset(&set_, SIGTERM);
    ::sigaddset(&set_, SIGHUP);
    ::pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }

  /// Returns when a signal came or `limit` (if any) has passed.
  void wait(std::optional<base::SimDuration> limit) const {
    if (!limit) {
      int signal = 0;
      ::sigwait(&set_, &signal);
      return;
    }
    const std::int64_t nanoseconds = limit->nanoseconds();
    const timespec time{nanoseconds / 1'000'000'000, nanoseconds % 1'000'000'000};
    while (::sigtimedwait(&set_, nullptr, &time) < 0 && errno == EINTR) {
    }
  }

 private:
  sigset_t set_{};
};

void print_buses(const rack::RackConfiguration& configuration, rack::Runner& runner) {
  for (std::size_t i = 0; i < configuration.buses.size(); ++i) {
    const rack::BusConfiguration& bus = configuration.buses[i];
    if (!bus.wire) {
      continue;
    }
    fmt::print("CAN bus {}, {}: {} device{}\n", bus.name,
               bus.bit_rate ? fmt::format("{} kbit/s", *bus.bit_rate / 1000) : "unlimited",
               bus.devices.size(), bus.devices.size() == 1 ? "" : "s");
    for (const rack::DeviceConfiguration& device : bus.devices) {
      fmt::print("  {}  ({}{})\n", device.name, rack::product_name(device.product),
                 address_text(device.product));
    }
    for (std::size_t port = 0; port < runner.bus(i).ports(); ++port) {
      fmt::print("Programs connect to {}:\n  {}\n", runner.bus(i).port(port).name(),
                 runner.bus(i).port(port).usage());
    }
  }
}

void print_networks(const rack::RackConfiguration& configuration, rack::Rack& rack,
                    rack::Runner& runner) {
  for (std::size_t i = 0; i < configuration.segments.size(); ++i) {
    const rack::SegmentConfiguration& segment = configuration.segments[i];
    const std::string redundant =
        segment.redundant() ? " and " + runner.link(i, ethercat::MasterInterface::secondary).name()
                            : std::string();
    fmt::print("Segment on {}{}: {} device{}\n", runner.link(i).name(), redundant,
               segment.devices.size(), segment.devices.size() == 1 ? "" : "s");
    for (const rack::NamedDevice& member : rack.devices(i)) {
      fmt::print("  {}  ({})\n", member.name, member.device->description().name);
    }
    fmt::print("{}", connection_hints(segment));
  }
  print_buses(configuration, runner);
  for (std::size_t i = 0; i < runner.line_count(); ++i) {
    print_line(configuration, rack.line(i).configuration(), runner.line(i).link());
  }
  for (std::size_t i = 0; i < runner.chip_count(); ++i) {
    print_chip(runner.chip(i).name());
  }
  print_chips_without_firmware(configuration);
}

void print_bus_end(const rack::CanNetwork& network, rack::BusThread& thread) {
  const can::BusStatistics& wire = network.bus().statistics();
  const rack::BusThreadStatistics statistics = thread.statistics();
  fmt::print("{}: {} frames ({} from ports), {} error frames, {} overruns\n", network.name(),
             wire.frames, statistics.frames_in, wire.error_frames, statistics.overruns);
  for (std::size_t i = 0; i < thread.ports(); ++i) {
    const link::CanLinkStatistics port = thread.port(i).statistics();
    fmt::print("  {}: {} frames from programs, {} to programs, {} dropped, {} malformed\n",
               thread.port(i).name(), port.frames_received, port.frames_sent, port.frames_dropped,
               port.malformed);
  }
}

void print_line_end(rack::SerialLineThread& thread) {
  const rack::SerialLineThreadStatistics statistics = thread.statistics();
  fmt::print(
      "{}: {} bytes from programs, {} to programs, {} lost by devices, {} nobody read, {} "
      "overruns\n",
      thread.link().name(), statistics.line.bytes_in, statistics.link.bytes_sent,
      statistics.line.bytes_lost, statistics.link.bytes_dropped, statistics.overruns);
}

/// Says what got lost between slaves, if anything did.
void print_lost_frames(const ethercat::SegmentStatistics& statistics) {
  if (statistics.dropped + statistics.corrupted + statistics.torn > 0) {
    fmt::print("  {} frames dropped and {} corrupted by events, {} torn between clocks\n",
               statistics.dropped, statistics.corrupted, statistics.torn);
  }
}

void print_end(const rack::RackConfiguration& configuration, rack::Rack& rack,
               rack::Runner& runner) {
  for (std::size_t i = 0; i < configuration.buses.size(); ++i) {
    if (configuration.buses[i].wire) {
      print_bus_end(rack.bus(i), runner.bus(i));
    }
  }
  for (std::size_t i = 0; i < runner.line_count(); ++i) {
    print_line_end(runner.line(i));
  }
  for (std::size_t i = 0; i < configuration.segments.size(); ++i) {
    const rack::SegmentStatistics statistics = runner.statistics(i);
    const double mean = statistics.frames == 0 ? 0.0
                                               : static_cast<double>(statistics.processing_ns) /
                                                     static_cast<double>(statistics.frames) * 1e-3;
    fmt::print(
        "{}: {} frames answered in {:.1f} us on average (worst {:.1f} us), {} not "
        "answered, {} dropped by the system, {} overruns\n",
        runner.link(i).name(), statistics.frames, mean,
        static_cast<double>(statistics.worst_processing_ns) * 1e-3, statistics.frames_unanswered,
        runner.link(i).statistics().frames_dropped, statistics.overruns);
    print_lost_frames(rack.segment(i).statistics());
  }
}

void run(const RunOptions& options) {
  const rack::RackConfiguration configuration = configuration_of(options);
  std::optional<base::SimDuration> limit;
  if (!options.duration.empty()) {
    limit = duration_option("--duration", options.duration);
  }
  const StopSignals signals;
  const auto logger = make_logger();
  rack::EventLog log(logger);
  rack::Rack rack(configuration, log);
  std::unique_ptr<web::Server> server;  // goes after the runner, which may have tasks of it
  rack::Runner runner(rack, configuration, logger);
  print_networks(configuration, rack, runner);
  server = open_web_server(options.web, rack, configuration, log, runner);
  fmt::print("Running; Ctrl-C ends it.\n");
  std::fflush(stdout);
  runner.start();
  if (server != nullptr) {
    server->start();
  }
  signals.wait(limit);
  if (server != nullptr) {
    server->stop();
  }
  runner.stop();
  print_end(configuration, rack, runner);
  if (rack.trace() != nullptr) {
    rack.trace()->finish(runner.now());
    print_trace_end(*rack.trace(), configuration.trace->file);
  }
  if (rack.recorder() && !rack.recorder()->good()) {
    throw Failure(
        fmt::format("recording to {} failed; is the disk full?", configuration.record->file));
  }
}

}  // namespace

void add_run_command(CLI::App& app) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "Run a rack of virtual devices on real interfaces");
  auto* file = command->add_option("rack", options->rack_file, "Rack file (TOML)");
  command->add_option("--device", options->device, "Product to run instead of a rack file")
      ->excludes(file);
  command
      ->add_option("--count", options->count,
                   "How many of --device, wired in line, or with node-IDs or addresses in a row")
      ->check(CLI::Range(1U, 500U))
      ->capture_default_str();
  command->add_option("--link", options->link,
                      "Link of the first segment: " + std::string(link::kLinkForms));
  command->add_option(
      "--port", options->ports,
      "Port of the first CAN bus, as often as needed: " + std::string(link::kCanLinkForms));
  command->add_option(
      "--serial", options->serial,
      "[INTERFACE=]LINE: serial line of --device, as often as needed; all of --count share it: " +
          std::string(link::kSerialLinkForms));
  command->add_option("--spi", options->spi,
                      "Socket for the firmware beside a chip given with --device: " +
                          std::string(link::kChipLinkForms));
  command->add_option("--bit-rate", options->bit_rate,
                      "Of the first CAN bus: kbit/s, or \"unlimited\"");
  command->add_option("--redundant", options->redundant,
                      "ethercat:INTERFACE at the end of the first segment, for cable redundancy");
  command
      ->add_option("--wait", options->wait,
                   "block: no load when idle; spin: fastest, takes a processor; adaptive: both")
      ->check(CLI::IsMember({"block", "spin", "adaptive"}));
  command->add_option("--cpu", options->cpu, "Processor for the first segment's thread");
  command
      ->add_option("--clock", options->clock,
                   "real: the machine's time; lockstep: time moves only with the master's frames")
      ->check(CLI::IsMember({"real", "lockstep"}));
  command->add_option("--capture", options->capture, "Write all frames to this pcap file");
  command->add_option("--record", options->record, "Write signals to this CSV file");
  command->add_option("--record-period", options->record_period,
                      "Simulated time between two rows, e.g. 1ms");
  command->add_option("--signals", options->signals, "Signals to record, e.g. \"*.axis0.*\"");
  auto* trace =
      command->add_option("--trace", options->trace,
                          "[DEVICE=]FILE: write the edges at the pins of a TMC8461 to this value "
                          "change dump, for GTKWave");
  command
      ->add_option(
          "--trace-pins", options->trace_pins,
          "Pins to trace, e.g. MFCIO04,MFC_HV0; without it those wired to something, but for DAC0")
      ->delimiter(',')
      ->needs(trace);
  command->add_option("--duration", options->duration, "Stop after this time, e.g. 10s");
  command->add_option("--state", options->state,
                      "Directory in which devices keep EEPROM content, parameters and firmware");
  command->add_flag("--no-emergencies", options->no_emergencies,
                    "Devices send no CoE emergencies, for masters that cannot take any");
  auto* http = command->add_option(
      "--http", options->web.http,
      "[ADDRESS:]PORT of a web server with REST, signals and metrics; without ADDRESS this machine "
      "only");
  command
      ->add_option("--http-token", options->web.token_file,
                   "File with the token that writes need, and from other machines all access")
      ->needs(http);
  command->footer(
      "Examples:\n"
      "  stator run racks/gantry.toml --link ethercat:eth1\n"
      "  stator run --device tmcm-3315 --link ethercat:eth1 --wait spin --cpu 1\n"
      "  stator run --device tmcm-3315 --link udp:0.0.0.0\n"
      "  stator run racks/gantry.toml --http 8080\n"
      "  stator run --device tmcc160 --port slcan:/tmp/stator-can0 --port socketcand:29536\n"
      "  stator run --device tmcm-142 --serial pty:/tmp/stator-serial\n"
      "  stator run --device tmc8461 --link ethercat:eth1 --spi unix:/tmp/stator-chip\n"
      "  stator run --device tmcm-3315 --link ethercat:eth1 --record run.csv --signals "
      "\"*.axis0.*\"");
  command->callback([options] { run(*options); });
}

}  // namespace stator::cli
